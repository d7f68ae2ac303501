#include "partition/published/separating_plane.h"

#include <Eigen/LU>
#include <cmath>

#include "geometry/homography.h"

namespace lightfit {

namespace {

// q of the rays, a linear form.   math.md (18)
absl::StatusOr<Eigen::RowVector3d> Coarseness(const Eigen::Matrix4d& map_from_world,
                                              const Light& light) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  return Eigen::RowVector3d(map_from_ray->row(2) /
                            std::cbrt(std::abs(map_from_ray->determinant())));
}

}  // namespace

absl::StatusOr<Eigen::RowVector4d> SeparatingPlane(const Eigen::Matrix4d& first_from_world,
                                                   const Eigen::Matrix4d& second_from_world,
                                                   const Light& light) {
  const absl::StatusOr<Eigen::RowVector3d> first = Coarseness(first_from_world, light);
  if (!first.ok()) return first.status();
  const absl::StatusOr<Eigen::RowVector3d> second = Coarseness(second_from_world, light);
  if (!second.ok()) return second.status();
  return Eigen::RowVector4d((*second - *first) * RayFromWorld(light));
}

}  // namespace lightfit
