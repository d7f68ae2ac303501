// jobs/schemes/published.h
//
// Schemes of papers: single maps (methods/) and plans (partition/published/).
// In:   a budget.
// Out:  Schemes.
#pragma once

#include <string>
#include <vector>

#include "jobs/schemes/budget.h"
#include "jobs/schemes/scheme.h"
#include "partition/published/plan_parts.h"

namespace lightfit {

// Named as the method.
Scheme MethodScheme(Method method, const SchemeBudget& budget);

// Slices of the view's depth at equal ratios, a map of the method in each: "ZP4+LiSPSM", "ZP4";
// in squares, and as "..., aspects" in Lloyd's aspects.
std::string SlicesName(Method method, int num_maps);
Scheme SlicesScheme(Method method, PlanShapes shapes, const SchemeBudget& budget);
std::vector<Scheme> SlicesSchemes(const SchemeBudget& budget);

// "PSSM4", "FP+ZP+W", "Tang", "Mikkelsen": docs/published_plans.md.
std::vector<Scheme> PublishedSchemes(const SchemeBudget& budget);

}  // namespace lightfit
