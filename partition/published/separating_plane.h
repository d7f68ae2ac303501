// partition/published/separating_plane.h
//
// Where two maps of one light are equally dense: a plane through the light.
// In:   two map_from_world, in texels; the light.
// Out:  the half space in which the first is the denser one.   published_plans.md (M1)
//
// Mikkelsen 2007, (7), in the form that serves suns as well: his determinants are 0 for those.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/light.h"

namespace lightfit {

// n with n . (x, 1) = q_second - q_first, world: >= 0 where the first is at least as dense as the
// second, on whatever surface, if both have w > 0 there. Zero or nearly so where they are equal
// everywhere. InvalidArgument when a matrix is not one of this light (MapFromRay()).
absl::StatusOr<Eigen::RowVector4d> SeparatingPlane(const Eigen::Matrix4d& first_from_world,
                                                   const Eigen::Matrix4d& second_from_world,
                                                   const Light& light);

}  // namespace lightfit
