#include "methods/view_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "methods/view_body.h"

namespace lightfit {

ViewFrame ViewFrame::OfPlane(const Eigen::Vector3d& plane) {
  ViewFrame frame;
  frame.across = plane.transpose() / plane.head<2>().norm();
  frame.along << -frame.across.y(), frame.across.x(), 0.0;
  return frame;
}

void ViewFrame::TurnAround() {
  across = -across;
  along = -along;
  depth_slope = -depth_slope;
}

void ViewFrame::LayOver(const LightBody& body) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector3d& ray : body.rays) {
    const double b = along.dot(ray) / ray.z();
    low = std::min(low, b);
    high = std::max(high, b);
  }
  along.z() = -low;
  length = high - low;
}

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

  ViewFrame frame = ViewFrame::OfPlane(plane);
  frame.depth_slope = frame.along * ray_from_world.leftCols<3>() * ViewDirection(camera);
  if (frame.depth_slope < 0.0) frame.TurnAround();
  if (!(frame.depth_slope > kAligned)) return std::nullopt;
  frame.LayOver(body);
  return frame;
}

}  // namespace lightfit
