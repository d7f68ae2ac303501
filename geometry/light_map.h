// geometry/light_map.h
//
// How a map of a light's rays is finished into a matrix, whoever found it: fit or published set-up.
// In:   map_from_ray (H, 3x3), the map's size, the range of depth.
// Out:  H that is not mirrored; map_from_world that is finite.   math.md 1 and 8
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/homography.h"
#include "geometry/light.h"
#include "geometry/map_size.h"

namespace lightfit {

// Seen from the light the map must not be mirrored, or triangles change their facing: a mirrored
// one is turned over, v becomes height - v.
Eigen::Matrix3d Unmirrored(Eigen::Matrix3d map_from_ray, MapSize map);

// MapFromWorld(), or InternalError where that is not finite.
absl::StatusOr<Eigen::Matrix4d> FinishMap(const Eigen::Matrix3d& map_from_ray,
                                          const Eigen::Matrix<double, 3, 4>& ray_from_world,
                                          const Light& light,
                                          DepthRange range,
                                          double w_min);

}  // namespace lightfit
