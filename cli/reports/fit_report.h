// cli/reports/fit_report.h
//
// What `lightfit fit` prints: tables, and where it is asked for what their columns mean.
#pragma once

#include <string>
#include <vector>

#include "jobs/fit_comparison.h"

namespace lightfit::cli {

// What the columns mean.
std::string FitLegend();

// `source` names the read-back. Ends in a newline.
std::string FitReportText(const std::string& source,
                          const Readback& readback,
                          MapSize map,
                          const FitOptions& options,
                          const std::vector<FitComparison>& comparisons,
                          bool has_legend = false);

// The same with plans of several maps.
std::string PlanReportText(const std::string& source,
                           const Readback& readback,
                           const PlanOptions& options,
                           const std::vector<FitComparison>& comparisons,
                           bool has_legend = false);

// Why a light has its focused map instead of a searched one; empty: it has not.
std::string FocusedInsteadText(const LightMatrix& matrix, const FitOptions& options);

// "global search, parallelogram, l2 metric": the choices in the command line's words.
std::string MethodText(const FitOptions& options);

// "global search, l1-edge": as much of it as fits over a picture.
std::string ShortMethodText(const FitOptions& options);

}  // namespace lightfit::cli
