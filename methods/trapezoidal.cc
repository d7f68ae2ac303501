#include "methods/trapezoidal.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"
#include "methods/focused.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "methods/view_frame.h"

namespace lightfit {

namespace {

absl::Status ValidateOptions(const TrapezoidalOptions& options) {
  if (options.focus_depth.has_value() &&
      (!(*options.focus_depth > 0.0) || !std::isfinite(*options.focus_depth))) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "tsm: focus_depth = %g, want finite and more than 0: camera depth, world units",
        *options.focus_depth));
  }
  if (!(options.focus_line > 0.0) || !(options.focus_line < 1.0)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("tsm: focus_line = %g, want more than 0 and less than 1; the paper has 0.8",
                        options.focus_line));
  }
  return absl::OkStatus();
}

// Whether the light sees all corners of one face inside the outline of another.
bool SeenInside(const LightBody& body,
                const std::array<Eigen::Vector3d, 8>& corners,
                int inner,
                int outer) {
  std::array<Eigen::Vector3d, 8> rays;
  for (int i = 0; i < 8; ++i) {
    rays[i] = body.ray_from_world * corners[i].homogeneous();
    if (!(rays[i].z() > 0.0)) return false;
  }
  bool left = true, right = true;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d side = rays[outer + i].cross(rays[outer + (i + 1) % 4]);
    for (int j = 0; j < 4; ++j) {
      const double turn = side.dot(rays[inner + j]);
      left &= turn >= 0.0;
      right &= turn <= 0.0;
    }
  }
  return left || right;
}

}  // namespace

absl::StatusOr<MethodMap> TrapezoidalMap(const MethodInput& input,
                                         const TrapezoidalOptions& options) {
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  if (!body->in_view) return FocusedMap(input);
  const Camera& camera = input.camera;
  if (camera.orthographic) return FocusedInstead(input, "the view is orthographic");
  const std::array<Eigen::Vector3d, 8> corners = FrustumCorners(camera);
  if (SeenInside(*body, corners, 0, 4) || SeenInside(*body, corners, 4, 0)) {
    return FocusedInstead(input, "the light sees the view's near and far face one in the other");
  }
  const Eigen::Vector3d near_centre = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
  const Eigen::Vector3d eye = EyePosition(camera);
  const std::optional<ViewFrame> frame = AlongView(*body, camera, near_centre - eye);
  if (!frame.has_value()) return FocusedInstead(input, "the light is along the view");

  const ViewDepths depths = ViewDepthsOf(camera, body->points);
  const double focus_depth =
      options.focus_depth.value_or(std::sqrt(depths.least * depths.greatest));
  const Eigen::Vector3d focus = eye + focus_depth / camera.near * (near_centre - eye);
  const Eigen::Vector3d focus_ray = body->ray_from_world * focus.homogeneous();
  constexpr double kLeastShare = 0.01;
  double share = 1.0;  // D / L; a focus that the light does not see asks for no warp
  if (focus_ray.z() > 0.0) share = frame->along.dot(focus_ray) / focus_ray.z() / frame->length;
  share = std::max(share, kLeastShare);
  const double s = options.focus_line;
  const double one_over_eta = share < s ? (s - share) / (frame->length * share * (1.0 - s)) : 0.0;
  return FitBody(*body, frame->Warped(one_over_eta), RectangleTurn::kAlongRows);
}

}  // namespace lightfit
