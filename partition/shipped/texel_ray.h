// partition/shipped/texel_ray.h
//
// The light's ray through a place of a map that no 4x4 matrix describes: what a renderer or a judge
// casts to fill the texel there.
#pragma once

#include <Eigen/Core>

namespace lightfit {

struct TexelRay {
  // World. The light itself; of a directional light a point of the ray in the plane through the
  // world's origin across its direction, which whoever casts moves back in front of the geometry.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // unit, the way light travels; world
};

}  // namespace lightfit
