// optimizer/global_search.h
//
// The best axis there is: candidates spread over the polar polygon, then Ceres, then a polish.
// In:   a summary, its evaluator, a start.
// Out:  the best fit found, never worse than the start, and the trace.   math.md 6
#pragma once

#include "optimizer/axis_evaluator.h"
#include "optimizer/line_search.h"
#include "optimizer/refine.h"

namespace lightfit {

// The reduced energy over the polar polygon has few local minima, usually one. Candidates lie on
// `grid_directions` spokes from the origin; the best of them start a refinement each, and a compass
// search (Hooke & Jeeves 1961, steps in both directions of two axes, halved when none helps)
// finishes where the derivative jumps and Ceres stops short.
SearchResult GlobalSearch(const Summary& summary,
                          AxisEvaluator& evaluator,
                          const AffineFit& start,
                          int grid_directions,
                          Refiner refiner,
                          std::string* solver_report);

// The last step alone: improves a fit until no neighbouring axis is better.
AffineFit PolishAxis(AxisEvaluator& evaluator, const AffineFit& start);

}  // namespace lightfit
