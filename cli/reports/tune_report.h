// cli/reports/tune_report.h
//
// What `lightfit tune` prints: how far each fit was from the least that was found.
#pragma once

#include <string>

#include "absl/types/span.h"
#include "cli/reports/compare_report.h"
#include "jobs/tune/tune.h"

namespace lightfit::cli {

// What the columns mean.
std::string TuneLegend();

// A table with a line for each light, and the totals. Ends in a newline.
std::string TuneReportText(const CompareHeading& heading,
                           const TuneOptions& options,
                           absl::Span<const TunedLight> lights,
                           bool has_legend = false);

}  // namespace lightfit::cli
