#include "geometry/ray_maps.h"

#include <Eigen/LU>
#include <cmath>

namespace lightfit {

RayMap::RayMap(const Eigen::Matrix3d& map_from_ray, double width, double height)
    : map_from_ray(map_from_ray),
      width(width),
      height(height),
      coarseness(map_from_ray.row(2).transpose() /
                 std::cbrt(std::abs(map_from_ray.determinant()))) {}

}  // namespace lightfit
