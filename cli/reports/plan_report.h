// cli/reports/plan_report.h
//
// What `lightfit fit --maps` prints of plans: a table of lights, one of their maps, what they mean.
// In:   PlanOptions, and the comparison of each light (ComparePlan()).
// Out:  text, and tables as base/table.h lays them out.
#pragma once

#include <string>
#include <vector>

#include "base/table.h"
#include "jobs/fit_comparison.h"

namespace lightfit::cli {

// "maps that are parallelograms, l1-edge metric, around what is shadowed".
std::string PlanMethodText(const PlanOptions& options);

// A row for each light: its plan beside single maps of as many texels.
Table PlanTable(const std::vector<FitComparison>& comparisons);

// A row for each map of each light, numbered as in the JSON file.
Table PlanMapTable(const std::vector<FitComparison>& comparisons);

// What the two tables mean.
std::string PlanLegend();

}  // namespace lightfit::cli
