// methods/dominant_plane.h
//
// The plane that most visible surfaces lie on: for MethodInput::plane.
// In:   points on surfaces with their unit normals, one for each pixel or sample.
// Out:  the plane that most of them share, its normal on their side; nothing when there is none.
//
// Normals vote in cells of a cube around the origin. The points of each of the fullest cells (with
// the cells around it) vote for an offset along their mean normal. The plane with most points near
// it is fitted again to those, by the direction of their least spread. Everything is in the order
// of the input, so the same input gives the same bits.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "absl/types/span.h"

namespace lightfit {

struct DominantPlaneOptions {
  double max_angle_rad = 0.1;   // of a point's normal to the plane's, more than 0, less than 0.5
  double max_distance = 0.005;  // of a point from the plane, in diagonals of all points' box, > 0
  double min_share = 0.05;      // of all points that a plane needs, or there is none
};

// `normals` has the size of `points`; pairs that are not finite, or whose normal is not of length 1
// (to 1e-3), are left out. Nothing when a plane has fewer than `min_share` of the rest, or fewer
// than three points; options out of range give nothing too.
std::optional<Eigen::Hyperplane<double, 3>> DominantPlane(absl::Span<const Eigen::Vector3d> points,
                                                          absl::Span<const Eigen::Vector3d> normals,
                                                          const DominantPlaneOptions& options = {});

}  // namespace lightfit
