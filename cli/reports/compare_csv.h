// cli/reports/compare_csv.h
//
// A comparison as comma-separated values.
// In:   LightComparisons with the same rows.
// Out:  text; numbers with all their digits.
#pragma once

#include <string>

#include "absl/types/span.h"
#include "jobs/compare/rows.h"

namespace lightfit::cli {

// A line of names, then one line for each light and method. Empty fields where there is no figure.
std::string CompareCsv(absl::Span<const LightComparison> lights);

}  // namespace lightfit::cli
