// render/clearance.h
//
// How far a point is from the surfaces of a scene.
// In:   a Scene or a RayCaster's, and a point.
// Out:  the distance to the nearest triangle, exact; every triangle is looked at.
#pragma once

#include <Eigen/Core>

#include "render/ray_caster.h"

namespace lightfit {

double DistanceToTriangle(const Eigen::Vector3d& point,
                          const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c);

// World units.
double Clearance(const RayCaster& caster, const Eigen::Vector3d& point);

}  // namespace lightfit
