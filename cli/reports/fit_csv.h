// cli/reports/fit_csv.h
//
// The fits of a read-back's lights as comma-separated values.
// In:   Readback, FitComparisons of matrices or plans.
// Out:  text; numbers with all their digits. The same bytes for the same fits: no times.
#pragma once

#include <string>
#include <vector>

#include "jobs/fit_comparison.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/readback.h"

namespace lightfit::cli {

// A line of names, with units where a figure has one, then a line for each light. Empty fields
// where there is no figure. `map` is the size of single maps where no plans were asked for.
std::string FitCsv(const Readback& readback,
                   MapSize map,
                   const FitOptions& options,
                   const std::vector<FitComparison>& lights);

}  // namespace lightfit::cli
