// geometry/polar_of_difference.h
//
// The polar of K - K, of a convex polygon K: its strips, as a convex polygon of rows.
// In:   K, counter-clockwise, with at least three vertices and area.
// Out:  half the boundary, one breakpoint for each direction of an edge of K.   math.md 5
//
// A strip with the unit normal n around K has the width W(n); its row n / W(n) runs over the
// boundary of the polar of K - K, a centrally symmetric convex polygon with one vertex per edge
// direction of K and one edge per antipodal vertex pair of K.
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "geometry/polygon.h"

namespace lightfit {

// One vertex of the polar polygon (a breakpoint: the strip lies along an edge of the polygon) and
// the antipodal pair that is touched from here to the next breakpoint.
struct PolarBreakpoint {
  Eigen::Vector2d row;   // n / W(n)
  Eigen::Vector2d pair;  // high - low of the pair after this breakpoint
  int low, high;         // that pair
};

// Half of them; the other half is the mirror image.
ScratchVector<PolarBreakpoint> PolarOfDifference(const Polygon& points);

}  // namespace lightfit
