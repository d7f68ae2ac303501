#include "render/sight.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "render/clearance.h"

namespace lightfit {
namespace {

std::string PointText(const Eigen::Vector3d& point) {
  return absl::StrFormat("(%g, %g, %g)", point.x(), point.y(), point.z());
}

}  // namespace

absl::StatusOr<std::string> CheckSight(const RayCaster& caster, const SurfaceImage& image) {
  const Eigen::AlignedBox3d& bounds = caster.bounds();
  const Eigen::Matrix4d& camera_from_world = image.camera.camera_from_world;
  const Eigen::Vector3d eye = -camera_from_world.topLeftCorner<3, 3>().transpose() *
                              camera_from_world.topRightCorner<3, 1>();
  if (image.num_surface == 0) {
    return absl::InvalidArgumentError(absl::StrCat("camera: sees nothing from ",
                                                   PointText(eye),
                                                   "; the scene reaches from ",
                                                   PointText(bounds.min()),
                                                   " to ",
                                                   PointText(bounds.max()),
                                                   ": move the eye or the target"));
  }
  if (image.camera.orthographic) return std::string();
  const double clearance = Clearance(caster, eye);
  const double resolution = caster.Resolution(eye);
  if (clearance <= resolution) {
    return absl::InvalidArgumentError(
        absl::StrFormat("camera: the eye %s touches a surface, %g away, want more than %g: move it",
                        PointText(eye),
                        clearance,
                        resolution));
  }
  double furthest = 0.0;
  for (const SurfacePoint& pixel : image.pixels) {
    if (pixel.is_surface()) furthest = std::max(furthest, (pixel.position - eye).norm());
  }
  constexpr double kSuspiciousShare = 0.01;
  const double extent = bounds.diagonal().norm();
  const bool sees_all_around = image.num_surface == static_cast<int64_t>(image.pixels.size());
  if (sees_all_around && furthest < kSuspiciousShare * extent) {
    return absl::StrFormat(
        "camera: all that the eye %s sees is within %g, in a scene %g across: "
        "is it inside an object?",
        PointText(eye),
        furthest,
        extent);
  }
  return std::string();
}

}  // namespace lightfit
