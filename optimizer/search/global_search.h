// optimizer/search/global_search.h
//
// The best axis there is: candidates spread over the polar polygon, then Ceres, then a polish.
// In:   a summary, its evaluator, a start.
// Out:  the best fit found, never worse than the start, and the trace.   math.md 6
#pragma once

#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/line_search.h"

namespace lightfit {

// The reduced energy over the polar polygon has few local minima, usually one. Candidates lie on
// `grid_directions` spokes from the origin; the best of them, no two of them neighbours, are each
// refined (optimizer/search/refine.h) and polished (optimizer/search/polish.h).
SearchResult GlobalSearch(const Summary& summary,
                          AxisEvaluator& evaluator,
                          const AffineFit& start,
                          int grid_directions,
                          Refiner refiner);

}  // namespace lightfit
