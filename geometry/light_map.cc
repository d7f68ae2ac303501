#include "geometry/light_map.h"

#include <Eigen/LU>

#include "absl/strings/str_format.h"

namespace lightfit {

Eigen::Matrix3d Unmirrored(Eigen::Matrix3d map_from_ray, MapSize map) {
  if (map_from_ray.determinant() < 0.0) {
    map_from_ray.row(1) = map.height * map_from_ray.row(2) - map_from_ray.row(1);
  }
  return map_from_ray;
}

absl::StatusOr<Eigen::Matrix4d> FinishMap(const Eigen::Matrix3d& map_from_ray,
                                          const Eigen::Matrix<double, 3, 4>& ray_from_world,
                                          const Light& light,
                                          DepthRange range,
                                          double w_min) {
  const Eigen::Matrix4d map_from_world =
      MapFromWorld(map_from_ray, ray_from_world, light, range, w_min);
  if (!map_from_world.allFinite()) {
    return absl::InternalError(
        absl::StrFormat("light \"%s\": the matrix is not finite; please report this", light.name));
  }
  return map_from_world;
}

}  // namespace lightfit
