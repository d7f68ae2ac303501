// cli/reports/allocate_report.h
//
// What `lightfit allocate` prints: a table, and what its columns mean.
// In:   AllocationReport, and what it was made from.
// Out:  text that ends in a newline.
#pragma once

#include <string>

#include "wire/allocation_json.h"

namespace lightfit::cli {

// What the columns mean, whichever there are.
std::string AllocationLegend();

// `source`: what was read, in one line. `image_scale`: pixels of the final image per pixel of the
// read-back. Fits without statistics, FitOptions::compute_statistics, are those of summaries.
std::string AllocationText(const AllocationReport& report,
                           const std::string& source,
                           double image_scale,
                           bool has_legend = false);

}  // namespace lightfit::cli
