#include "geometry/homography.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

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

absl::StatusOr<Eigen::Matrix3d> MapFromRay(const Eigen::Matrix4d& map_from_world,
                                           const Light& light) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (!map_from_world.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": map_from_world is not finite", light.name));
  }
  Eigen::Matrix<double, 3, 4> rows;
  rows << map_from_world.row(0), map_from_world.row(1), map_from_world.row(3);
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  Eigen::Matrix3d map_from_ray;
  if (light.kind == Light::Kind::kPoint) {
    map_from_ray = rows.leftCols<3>() * ray_from_world.leftCols<3>().transpose();
  } else {
    map_from_ray = rows * ray_from_world.transpose();
  }
  // What the matrix does with the light itself must be nothing: rows * light = 0. It is measured in
  // the size of the terms that cancel.
  const Eigen::Vector4d centre = light.HomogeneousPosition();
  for (int row = 0; row < 3; ++row) {
    constexpr double kAllowedMiss = 1e-5;  // matrices in single precision are welcome
    const double terms = rows.row(row).cwiseAbs() * centre.cwiseAbs();
    if (std::abs(rows.row(row).dot(centre)) > kAllowedMiss * terms + 1e-300) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": the rays of map_from_world do not leave the light: row %d times the light "
          "is %g, want 0 (terms of size %g). Is it the matrix of another light, transposed, or not "
          "from world space?",
          light.name,
          row < 2 ? row + 1 : 4,
          rows.row(row).dot(centre),
          terms));
    }
  }
  const double scale =
      map_from_ray.row(0).norm() * map_from_ray.row(1).norm() * map_from_ray.row(2).norm();
  if (!(std::abs(map_from_ray.determinant()) > 1e-14 * scale)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": map_from_world is singular: its map has no area", light.name));
  }
  return map_from_ray;
}

}  // namespace lightfit
