// geometry/ray_hull.h
//
// The extreme rays of a cone, found without any rounding: the same ones however the rays came
// together.
// In:   rays.
// Out:  those that are extreme, in an order that depends on them alone.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace lightfit {

// Rays inside the cone of others, or exactly on its faces, are left out; of rays in the very same
// direction one stays. Counter-clockwise seen against the rays (det [a b c] > 0), the
// lexicographically smallest first. Hulls of hulls are hulls: ExtremeRays(A + B) equals
// ExtremeRays(ExtremeRays(A) + ExtremeRays(B)), bit for bit.
//
// Where all rays lie in one plane with the origin there is no cone, and they all stay, each once,
// in lexicographical order. Nothing when the rays surround the origin: no plane through it has all
// of them strictly on one side. The rays must be finite, none zero.
std::optional<std::vector<Eigen::Vector3d>> ExtremeRays(std::vector<Eigen::Vector3d> rays);

}  // namespace lightfit
