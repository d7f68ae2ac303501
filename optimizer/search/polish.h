// optimizer/search/polish.h
//
// The last steps to the optimum, where the reduced energy has creases.
// In:   a summary, a fitted map to start from.
// Out:  a fitted map that is at least as good, with no better one close by.
//
// Where the shape's touched rays change, the derivative of E*(p) jumps, and the optimum often lies
// in such a crease. Least squares stop short there. BFGS with a line search by bisection for the
// weak Wolfe conditions does not: its curvature estimate grows across a crease until steps run
// along it (Lewis & Overton 2013, "Nonsmooth optimization via quasi-Newton methods").
#pragma once

#include "optimizer/search/refine.h"

namespace lightfit {

enum class Polish {
  kQuick,  // enough to tell which of several fits leads further down: to about 1e-3 of the energy
  kThorough,  // to about 1e-5, and a look around whether any axis close by is better
  kExact      // to about 1e-10: the same optimum from wherever one comes; ten times the evaluations
};

// Never returns a fit with more energy than `start`.
SearchResult PolishAxis(const Summary& summary,
                        const AffineProblem& problem,
                        double min_w,
                        Polish polish,
                        const AffineFit& start);

}  // namespace lightfit
