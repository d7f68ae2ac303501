#include "render/shadow_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace lightfit {

double StartOfSunRays(const Eigen::Vector3d& direction, const Eigen::AlignedBox3d& bounds) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    nearest = std::min(
        nearest,
        direction.dot(bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  return nearest - 1e-3 * bounds.diagonal().norm();
}

MapRays::MapRays(const Light& light,
                 const Eigen::Matrix3d& map_from_ray,
                 const Eigen::AlignedBox3d& bounds)
    : is_point_(light.kind == Light::Kind::kPoint), ray_from_map_(map_from_ray.inverse()) {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  axes_ = ray_from_world.leftCols<3>();
  if (is_point_) {
    centre_ = light.position;
    return;
  }
  const Eigen::Vector3d direction = light.direction.stableNormalized();
  axes_.row(2) = direction.transpose();
  centre_ = StartOfSunRays(direction, bounds) * direction;
}

std::optional<Ray> MapRays::At(double u, double v) const {
  // With X = H^-1 (u, v, 1), w = h3.X = 1 > 0: X points along the light's rays.
  const Eigen::Vector3d X = ray_from_map_ * Eigen::Vector3d(u, v, 1.0);
  if (is_point_) return Ray{centre_, (axes_.transpose() * X).normalized()};
  if (!(X.z() > 0.0)) return std::nullopt;
  return Ray{centre_ + axes_.topRows<2>().transpose() * X.hnormalized(), axes_.row(2).transpose()};
}

}  // namespace lightfit
