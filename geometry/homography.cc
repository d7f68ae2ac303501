#include "geometry/homography.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

// A distance that receivers at one depth are taken apart by.
double LeastExtent(const Eigen::Matrix<double, 3, 4>& rows, const Light& light, DepthRange range) {
  const double furthest = std::max(std::abs(range.near), std::abs(range.far));
  constexpr double kTiny = 1e-300;
  if (light.kind == Light::Kind::kPoint) return std::max(1e-6 * furthest, kTiny);
  // Depths of a directional light are from the origin, wherever that is: of them no more than what
  // doubles need. Texels per area are |det H| where w is 1.
  const double density = std::abs((rows * RayFromWorld(light).transpose()).determinant());
  const double texel_side = density > 0.0 ? 1.0 / std::sqrt(density) : 0.0;
  return std::max({std::isfinite(texel_side) ? texel_side : 0.0, 1e-12 * furthest, kTiny});
}

}  // namespace

Eigen::Matrix4d MapFromWorld(const Eigen::Matrix3d& map_from_ray,
                             const Eigen::Matrix<double, 3, 4>& ray_from_world,
                             const Light& light,
                             DepthRange range,
                             double w_min) {
  const Eigen::Matrix<double, 3, 4> rows = map_from_ray * ray_from_world;
  // Receivers at one depth still want a row that separates near from far.
  range.far = std::max(range.far, range.near + LeastExtent(rows, light, range));

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
  // The inverse of ray_from_world, whose rows are orthonormal: those of a point light but for their
  // last column.
  Eigen::Matrix<double, 4, 3> world_from_ray = ray_from_world.transpose();
  if (light.kind == Light::Kind::kPoint) world_from_ray.row(3).setZero();
  const Eigen::Matrix3d map_from_ray = rows * world_from_ray;
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
  constexpr double kRounding = 1e-14;  // some fifty roundings
  if (IsSingular(map_from_ray, rows.cwiseAbs() * world_from_ray.cwiseAbs(), kRounding)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": map_from_world is singular: its map has no area", light.name));
  }
  return map_from_ray;
}

bool IsSingular(const Eigen::Matrix3d& homography, const Eigen::Matrix3d& size, double share) {
  double terms = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    terms += size(0, i) * (size(1, j) * size(2, k) + size(1, k) * size(2, j));
  }
  return !(std::abs(homography.determinant()) > share * terms);
}

}  // namespace lightfit
