#include "partition/published/face_partition.h"

#include <Eigen/Geometry>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "methods/view_frame.h"
#include "partition/published/equal_maps.h"
#include "partition/published/face_cells.h"
#include "partition/published/least_error_warp.h"

namespace lightfit {

namespace {

absl::Status ValidateOptions(const FacePartitionOptions& options) {
  if (options.num_parts < 1 || options.num_parts > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("num_parts = %d, want 1 ... %d", options.num_parts, kMaxPlanMaps));
  }
  return ValidateMargin("FacePartition", options.margin_texels);
}

// The sum of the directions that the face's edges have for the light at the eye: their bisector.
Eigen::Vector3d BisectorOf(const FaceCell& cell, const Light& light, const Eigen::Vector3d& eye) {
  const Eigen::Vector3d ray =
      (light.kind == Light::Kind::kPoint ? Eigen::Vector3d(eye - light.position) : light.direction)
          .stableNormalized();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& edge : cell.edges) {
    sum += (edge - edge.dot(ray) * ray).stableNormalized();
  }
  return sum;
}

// Along the bisector from the eye, b growing outwards. Nothing where the light sees no line.
std::optional<ViewFrame> AlongFace(const LightBody& body,
                                   const FaceCell& cell,
                                   const Eigen::Vector3d& eye) {
  const Eigen::Vector3d eye_ray = body.ray_from_world * eye.homogeneous();
  const Eigen::Vector3d step =
      body.ray_from_world.leftCols<3>() * BisectorOf(cell, body.light, eye);
  const Eigen::Vector3d plane = eye_ray.cross(step);
  if (!(plane.head<2>().norm() > 0.0)) return std::nullopt;
  ViewFrame frame = ViewFrame::OfPlane(plane);
  // b = along.X / X_3 is monotonic on the way outwards.
  if (frame.along.dot(step) * eye_ray.z() < frame.along.dot(eye_ray) * step.z()) {
    frame.TurnAround();
  }
  frame.LayOver(body);
  return frame;
}

// Pixels' widths are those that texels of the light's plane meet.
std::vector<WarpCorner> CornersAlong(const LightBody& body,
                                     const ViewFrame& frame,
                                     const Camera& camera) {
  std::vector<WarpCorner> corners;
  for (size_t i = 0; i < body.points.size(); ++i) {
    const double light_depth = body.rays[i].z();
    corners.push_back({frame.along.dot(body.rays[i]) / light_depth,
                       CameraDepth(camera, body.points[i]) / light_depth});
  }
  return corners;
}

absl::StatusOr<MethodMap> MapOfCell(const LightBody& body,
                                    const FaceCell& cell,
                                    const Camera& camera,
                                    bool warp) {
  std::optional<ViewFrame> frame;
  if (warp && cell.side >= 0) frame = AlongFace(body, cell, EyePosition(camera));
  if (!frame.has_value()) {
    return FitBody(body, Eigen::Matrix3d::Identity(), RectangleTurn::kMinArea);
  }
  const double one_over_n = LeastErrorWarp(CornersAlong(body, *frame, camera));
  return FitBody(body, frame->Warped(one_over_n), RectangleTurn::kAlongRows);
}

}  // namespace

absl::StatusOr<Plan> FacePartition(const MethodInput& input, const FacePartitionOptions& options) {
  if (absl::Status status = ValidateMethodInput(input); !status.ok()) return status;
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  MethodInput part = input;
  part.map = {1, 1};
  std::vector<PlanPart> parts;
  if (!input.camera.orthographic) {
    for (const FaceCell& cell :
         FaceCells(input.light, input.camera, options.num_parts, options.has_near_face)) {
      part.cuts = input.cuts;
      part.cuts.insert(part.cuts.end(), cell.half_spaces.begin(), cell.half_spaces.end());
      if (ViewBody(part.camera, part.receivers, part.cuts).empty()) continue;
      absl::StatusOr<LightBody> body = BodyInView(part);
      if (!body.ok()) return body.status();
      if (!body->in_view) continue;
      const absl::StatusOr<MethodMap> map = MapOfCell(*body, cell, input.camera, options.warp);
      if (!map.ok()) return map.status();
      parts.push_back({map->map_from_world, cell.half_spaces, std::move(body->points)});
    }
  }
  if (parts.empty()) {
    part.cuts = input.cuts;
    const absl::StatusOr<MethodMap> map = SetUpMap(Method::kFocused, part);
    if (!map.ok()) return map.status();
    parts.push_back({map->map_from_world, {}, {}});
  }
  return PlanOfParts(input, parts, options.shapes, options.margin_texels);
}

}  // namespace lightfit
