#include "methods/view_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "methods/view_body.h"

namespace lightfit {

Eigen::Matrix3d ViewFrame::Warped(double one_over_n) const {
  Eigen::Matrix3d warped_from_ray;
  warped_from_ray.row(0) = across;
  warped_from_ray.row(1) = along;
  warped_from_ray.row(2) = Eigen::RowVector3d::UnitZ() + one_over_n * along;
  return warped_from_ray;
}

std::optional<ViewFrame> AlongView(const LightBody& body,
                                   const Camera& camera,
                                   const Eigen::Vector3d& direction) {
  const Eigen::Matrix<double, 3, 4>& ray_from_world = body.ray_from_world;
  const Eigen::Vector3d eye_ray = ray_from_world * EyePosition(camera).homogeneous();
  const Eigen::Vector3d direction_ray = ray_from_world.leftCols<3>() * direction.normalized();
  const Eigen::Vector3d plane = eye_ray.cross(direction_ray);
  const double length = plane.head<2>().norm();
  // A directional light has X_3 = 1 at the eye, so that this is the sine in both cases.
  const double scale =
      body.light.kind == Light::Kind::kPoint ? std::max(eye_ray.norm(), 1e-300) : 1.0;
  if (!(length > kAligned * scale)) return std::nullopt;

  ViewFrame frame;
  frame.across = plane.transpose() / length;
  frame.along << -frame.across.y(), frame.across.x(), 0.0;
  frame.depth_slope = frame.along * ray_from_world.leftCols<3>() * ViewDirection(camera);
  if (frame.depth_slope < 0.0) {
    frame.across = -frame.across;
    frame.along = -frame.along;
    frame.depth_slope = -frame.depth_slope;
  }
  if (!(frame.depth_slope > kAligned)) return std::nullopt;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector3d& ray : body.rays) {
    const double b = frame.along.dot(ray) / ray.z();
    low = std::min(low, b);
    high = std::max(high, b);
  }
  frame.along.z() = -low;
  frame.length = high - low;
  return frame;
}

}  // namespace lightfit
