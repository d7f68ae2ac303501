// geometry/homography.h
//
// Between the homography of a map and the 4x4 matrix that a renderer multiplies by.
// In:   map_from_ray (H, 3x3), ray_from_world (3x4), the depth row; or somebody's 4x4.
// Out:  map_from_world, (u w, v w, z w, w); or the H that is in it.   math.md 1 and 8
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/light.h"

namespace lightfit {

// Distances of the receivers from the light, along some direction, world units.
struct DepthRange {
  double near = 0.0;
  double far = 0.0;
};

// Rows 1, 2 and 4 are H ray_from_world. Row 3 makes z/w grow along every ray, from 0 at the nearest
// to 1 at the furthest receiver:
//   point light:       z w = A (p.X) + B with w = p.X, so z = A + B / w is monotonic along a ray;
//                      `range` bounds p.X over the receivers, near > 0.
//   directional light: z w = A (depth - near), depth along the direction of travel;
//                      `range` bounds depth, `w_min` is the smallest w of a receiver, so that
//                      z <= 1 wherever w >= w_min.
// Casters between the light and `range.near` get z < 0 and must be clamped ("pancaking",
// Lloyd 2006, 6.4). An empty range (far <= near) is widened to have some depth.
Eigen::Matrix4d MapFromWorld(const Eigen::Matrix3d& map_from_ray,
                             const Eigen::Matrix<double, 3, 4>& ray_from_world,
                             const Light& light,
                             DepthRange range,
                             double w_min);

// H of a matrix that somebody else made: rows 1, 2 and 4 are H ray_from_world, with
// RayFromWorld(light). The sign is that with w > 0 in front. InvalidArgument when the matrix is not
// finite or singular (IsSingular()), or its rays do not all leave the light (its centre of
// projection is elsewhere).
absl::StatusOr<Eigen::Matrix3d> MapFromRay(const Eigen::Matrix4d& map_from_world,
                                           const Light& light);

// Whether the determinant of a homography cannot be told from zero: `share` of the sum of its six
// terms' sizes, where `size` bounds the terms that each entry was summed from. It depends neither
// on the units of rows and columns nor, up to rounding, on where the origin of the rays is; with
// lengths of rows for the terms' sizes it would fall with the square of the origin's distance.
bool IsSingular(const Eigen::Matrix3d& homography, const Eigen::Matrix3d& size, double share);
inline bool IsSingular(const Eigen::Matrix3d& homography, double share) {
  return IsSingular(homography, homography.cwiseAbs(), share);
}

}  // namespace lightfit
