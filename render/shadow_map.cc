#include "render/shadow_map.h"

#include <Eigen/LU>
#include <limits>

namespace lightfit {

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
  double nearest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    nearest = std::min(
        nearest,
        direction.dot(bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  centre_ = (nearest - 1e-3 * bounds.diagonal().norm()) * direction;
}

std::optional<Ray> MapRays::At(double u, double v) const {
  // With X = H^-1 (u, v, 1), w = h3.X = 1 > 0: X points along the light's rays.
  const Eigen::Vector3d X = ray_from_map_ * Eigen::Vector3d(u, v, 1.0);
  if (is_point_) return Ray{centre_, (axes_.transpose() * X).normalized()};
  if (!(X.z() > 0.0)) return std::nullopt;
  return Ray{centre_ + axes_.topRows<2>().transpose() * X.hnormalized(), axes_.row(2).transpose()};
}

ShadowMap RenderShadowMap(const RayCaster& caster,
                          const Light& light,
                          const Eigen::Matrix3d& map_from_ray,
                          MapSize size,
                          absl::Span<const uint8_t> wanted) {
  ShadowMap map;
  map.size = size;
  map.distance.assign(static_cast<size_t>(size.width) * size.height,
                      std::numeric_limits<double>::infinity());
  const MapRays rays(light, map_from_ray, caster.bounds());
  ParallelFor(size.height, 8, caster.num_threads(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      for (int column = 0; column < size.width; ++column) {
        const size_t texel = static_cast<size_t>(row) * size.width + column;
        if (!wanted.empty() && wanted[texel] == 0) continue;
        const std::optional<Ray> ray = rays.At(column + 0.5, row + 0.5);
        if (ray.has_value()) map.distance[texel] = caster.FirstHit(*ray).distance;
      }
    }
  });
  return map;
}

}  // namespace lightfit
