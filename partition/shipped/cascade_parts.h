// partition/shipped/cascade_parts.h
//
// Where cascades split the view in depth, and which receivers are in a part.
// In:   a range of camera depth, how many parts.
// Out:  the depths between parts; half spaces of a Plan's map.
//
// The practical split (Zhang et al. 2006) is between the logarithmic one, whose parts have one
// ratio of depths, and the uniform one, whose parts have one length.   published_plans.md
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/scratch.h"
#include "geometry/camera.h"

namespace lightfit {

// num_parts + 1 camera depths from `near` to `far`, near <= far:
//   z_k = lambda near (far / near)^(k / K) + (1 - lambda) (near + (far - near) k / K).
// near > 0 unless lambda is 0.
std::vector<double> CascadeSplits(double near, double far, int num_parts, double lambda);

// The receivers whose camera depth is at least `from` and at most `to`. Infinity: no such bound.
ScratchVector<Eigen::RowVector4d> BetweenDepths(const Camera& camera, double from, double to);

}  // namespace lightfit
