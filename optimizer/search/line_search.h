// optimizer/search/line_search.h
//
// Chong & Gortler's Algorithm 1: rotate the axis against the gradient, keep the best.   math.md 6
// In:   an AxisEvaluator, a starting axis, the number of rounds.
// Out:  the best fit seen, never worse than the start, and the trace.
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/search_result.h"

namespace lightfit {

// The angles of Chong & Gortler 2.4, degrees. The negative one explores beyond local minima.
inline constexpr double kLineSearchAnglesDeg[] = {-10, 3, 5, 9, 16, 23, 30, 40, 50};

// In every round (step 4 of the algorithm) the axis p is rotated about p x (-dE/dp) by each of the
// angles and the affine part refitted; the best so far starts the next round. Rotations take place
// in the ray space of the evaluator's AffineProblem. Angles at which the axis cannot be used are
// skipped. Requires that `start` can be used.
//
// The gradient holds h1, h2 fixed for texel coordinates from 0 to the map's size, so that it
// depends on which corner of the rectangle is texel (0, 0), which the paper leaves open. It is the
// corner from which the fitted rectangle's edges run (geometry/enclosing_rectangle.h).
SearchResult RotationLineSearch(AxisEvaluator& evaluator, const AffineFit& start, int rounds);

}  // namespace lightfit
