// cli/reports/tune_report.h
//
// What `lightfit tune` prints: how far each fit was from the least that was found.
#pragma once

#include <string>

#include "absl/types/span.h"
#include "cli/reports/compare_report.h"
#include "jobs/tune/tune.h"

namespace lightfit::cli {

// A table with a line for each light, the totals, and what the numbers mean. Ends in a newline.
std::string TuneReportText(const CompareHeading& heading,
                           const TuneOptions& options,
                           absl::Span<const TunedLight> lights);

}  // namespace lightfit::cli
