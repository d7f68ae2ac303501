#include "methods/perspective.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "methods/focused.h"
#include "methods/light_body.h"
#include "methods/view_body.h"

namespace lightfit {

namespace {

// Clip space of the virtual camera, x, y and z in -1 ... 1, z over the given depths.
Eigen::Matrix4d ClipFromWorld(const Camera& camera, ViewDepths depths, double pull_back) {
  Camera virtual_camera = camera;
  virtual_camera.camera_from_world(2, 3) += pull_back;
  const Eigen::Matrix<double, 3, 4> pixel = PixelFromWorld(virtual_camera);
  const double near = depths.least + pull_back;
  const double far = std::max(depths.greatest + pull_back, near * (1.0 + 1e-6));
  Eigen::Matrix4d clip_from_world;
  clip_from_world.row(0) = 2.0 / camera.width * pixel.row(0) - pixel.row(2);
  clip_from_world.row(1) = 2.0 / camera.height * pixel.row(1) - pixel.row(2);
  // z = (far + near) / (far - near) - 2 far near / ((far - near) depth)
  clip_from_world.row(2) = (far + near) / (far - near) * pixel.row(2) -
                           2.0 * far * near / (far - near) * Eigen::RowVector4d::UnitW();
  clip_from_world.row(3) = pixel.row(2);
  return clip_from_world;
}

// Turns the axis (row 3, w) towards the focused one (X_3) until w on the body is at least
// `least_share` of what it is in the middle. Returns whether it had to. w is linear in the turn.
bool TurnAxis(const LightBody& body, double least_share, Eigen::Matrix3d* warped_from_ray) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : body.rays) middle += ray / ray.z();
  middle /= static_cast<double>(body.rays.size());  // X_3 = 1 there
  const double middle_w = warped_from_ray->row(2).dot(middle);
  if (!(middle_w > 0.0)) {
    warped_from_ray->row(2) = Eigen::RowVector3d::UnitZ();
    return true;
  }
  warped_from_ray->row(2) /= middle_w;
  double turn = 0.0;
  for (const Eigen::Vector3d& ray : body.rays) {
    const double w = warped_from_ray->row(2).dot(ray) / ray.z();
    if (w < least_share) turn = std::max(turn, (least_share - w) / (1.0 - w));
  }
  warped_from_ray->row(2) *= 1.0 - turn;
  (*warped_from_ray)(2, 2) += turn;
  return turn > 0.0;
}

}  // namespace

absl::StatusOr<MethodMap> PerspectiveMap(const MethodInput& input,
                                         const PerspectiveOptions& options) {
  if (!(options.pull_back >= 0.0) || !std::isfinite(options.pull_back)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "psm: pull_back = %g, want finite and at least 0, world units", options.pull_back));
  }
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return body.status();
  if (!body->in_view) return FocusedMap(input);
  const Camera& camera = input.camera;
  if (camera.orthographic) return FocusedInstead(input, "the view is orthographic");

  double pull_back = options.pull_back;
  if (input.light.kind == Light::Kind::kPoint) {
    pull_back = std::max(pull_back, -CameraDepth(camera, input.light.position));
  }
  const ViewDepths depths = ViewDepthsOf(camera, body->points);
  const Eigen::Matrix4d clip_from_world = ClipFromWorld(camera, depths, pull_back);
  const Eigen::Vector4d light = clip_from_world * input.light.HomogeneousPosition();
  const Eigen::Vector3d v = light.head<3>();
  if (!(v.norm() > 1e-9 * std::abs(light.w()))) {
    return FocusedInstead(input, "the light is in the middle of the view's unit cube");
  }
  const Eigen::Matrix3d axes = FrameAlong(v);
  Eigen::Matrix<double, 3, 4> warped_from_clip = Eigen::Matrix<double, 3, 4>::Zero();
  warped_from_clip.topLeftCorner<2, 3>() = axes.topRows<2>();
  warped_from_clip.row(2) << -light.w() / v.squaredNorm() * v.transpose(), 1.0;
  Eigen::Matrix3d warped_from_ray = HomographyOfRows(*body, warped_from_clip * clip_from_world);

  // What a light from above asks for is the ratio of the depths: it has to remain possible.
  const double least_share =
      std::min(0.02, 0.5 * (depths.least + pull_back) / (depths.greatest + pull_back));
  const bool turned = TurnAxis(*body, least_share, &warped_from_ray);
  if (IsSingular(warped_from_ray, 1e-12)) {
    return FocusedInstead(input, "the middle of the view's unit cube is behind the light");
  }
  absl::StatusOr<MethodMap> map = FitBody(*body, warped_from_ray, RectangleTurn::kMinArea);
  if (map.ok() && turned) {
    map->note =
        "psm: the axis is turned, as the unit cube fills more than half of the light's view";
  }
  return map;
}

}  // namespace lightfit
