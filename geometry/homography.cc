#include "geometry/homography.h"

#include <algorithm>
#include <cmath>

namespace lightfit {

Eigen::Matrix4d MapFromWorld(const Eigen::Matrix3d& map_from_ray,
                             const Eigen::Matrix<double, 3, 4>& ray_from_world,
                             const Light& light,
                             DepthRange range,
                             double w_min) {
  // Receivers at one depth still want a row that separates near from far.
  const double least_extent = 1e-6 * std::max(std::abs(range.near), std::abs(range.far)) + 1e-12;
  range.far = std::max(range.far, range.near + least_extent);

  const Eigen::Matrix<double, 3, 4> rows = map_from_ray * ray_from_world;
  Eigen::Matrix4d map_from_world;
  map_from_world.row(0) = rows.row(0);
  map_from_world.row(1) = rows.row(1);
  map_from_world.row(3) = rows.row(2);
  if (light.kind == Light::Kind::kPoint) {
    // 0 = A + B / near, 1 = A + B / far.
    const double a = range.far / (range.far - range.near);
    map_from_world.row(2) = a * rows.row(2);
    map_from_world(2, 3) -= a * range.near;
  } else {
    const double a = w_min / (range.far - range.near);
    map_from_world.row(2) << a * light.direction.stableNormalized().transpose(), -a * range.near;
  }
  return map_from_world;
}

}  // namespace lightfit
