// jobs/schemes/fitted.h
//
// Schemes that are fitted to a read-back: ours, and the published algorithm of one map.
// In:   a name, PlanOptions; a single map is the plan of one.
// Out:  Scheme.
#pragma once

#include <string>

#include "jobs/schemes/scheme.h"
#include "partition/plan_options.h"

namespace lightfit {

Scheme FittedScheme(const std::string& name, const PlanOptions& options);

// Chong and Gortler's Algorithm 1 in normalised rays instead of light space; what
// FitOptions::AsPublished() keeps of `fit` is kept.
FitOptions LineOptions(const FitOptions& fit);

// One map of that size in place of the plan.
PlanOptions OneMapOf(const FitOptions& fit, MapSize map, double guard_texels = 0.0);

}  // namespace lightfit
