#include "methods/lispsm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_format.h"
#include "methods/focused.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "methods/view_frame.h"

namespace lightfit {

namespace {

absl::Status ValidateOptions(const LispsmOptions& options) {
  if (!(options.n_scale > 0.0) || !std::isfinite(options.n_scale)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "lispsm: n_scale = %g, want finite and more than 0; 1 is the paper's", options.n_scale));
  }
  if (options.n.has_value() && !(*options.n > 0.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "lispsm: n = %g, want more than 0: the distance from the warp's centre to the receivers",
        *options.n));
  }
  if (options.centre.has_value() && !options.centre->allFinite()) {
    return absl::InvalidArgumentError("lispsm: centre is not finite, want a world point");
  }
  return absl::OkStatus();
}

// Where the body begins along the warp.
struct BodyStart {
  double camera_depth = std::numeric_limits<double>::infinity();
  double light_depth = 0.0;  // 1 for a directional light
};

// Of corners that begin it together those nearest to the camera count, and count alike: the four of
// a near plane that the light sees edge-on.
BodyStart StartOf(const LightBody& body, const ViewFrame& frame, const Camera& camera) {
  constexpr double kSamePlace = 1e-6, kSameDepth = 1e-6;
  const auto along = [&](const Eigen::Vector3d& ray) { return frame.along.dot(ray) / ray.z(); };
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& ray : body.rays) least = std::min(least, along(ray));
  BodyStart start;
  double sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < body.points.size(); ++i) {
    if (along(body.rays[i]) > least + kSamePlace * frame.length) continue;
    const double depth = CameraDepth(camera, body.points[i]);
    if (depth > start.camera_depth * (1.0 + kSameDepth)) continue;
    if (depth < start.camera_depth * (1.0 - kSameDepth)) {
      start.camera_depth = depth;
      sum = 0.0;
      count = 0;
    }
    sum += body.rays[i].z();
    ++count;
  }
  start.light_depth = sum / count;
  return start;
}

double DistanceN(const LightBody& body,
                 const ViewFrame& frame,
                 const Camera& camera,
                 LispsmOptions::Formula formula) {
  const BodyStart start = StartOf(body, frame, camera);
  const double slope = frame.depth_slope * start.light_depth;
  if (formula == LispsmOptions::Formula::kSimple) {
    return (camera.near + std::sqrt(camera.near * camera.far)) / slope;
  }
  const double z0 = start.camera_depth, z1 = z0 + slope * frame.length;
  return (z0 + std::sqrt(z0 * z1)) / slope;
}

}  // namespace

absl::StatusOr<MethodMap> LispsmMap(const MethodInput& input, const LispsmOptions& options) {
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  if (!body->in_view) return FocusedMap(input);
  if (input.camera.orthographic) return FocusedInstead(input, "the view is orthographic");
  std::optional<ViewFrame> frame = AlongView(*body, input.camera, ViewDirection(input.camera));
  if (!frame.has_value()) return FocusedInstead(input, "the light is along the view");

  if (options.centre.has_value()) {
    const Eigen::Vector3d ray = body->ray_from_world * options.centre->homogeneous();
    if (!(ray.z() > 0.0)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "lispsm: centre = (%g, %g, %g) is behind the light, want a point in front of it",
          options.centre->x(),
          options.centre->y(),
          options.centre->z()));
    }
    frame->across.z() -= frame->across.dot(ray) / ray.z();
  }
  const double n =
      options.n_scale * options.n.value_or(DistanceN(*body, *frame, input.camera, options.formula));
  return FitBody(*body, frame->Warped(1.0 / n), RectangleTurn::kAlongRows);
}

}  // namespace lightfit
