// cli/reports/shot_report.h
//
// What `lightfit shot` prints: a table of all modes, where results are, and what went wrong.
#pragma once

#include <string>
#include <vector>

#include "jobs/shot/context.h"

namespace lightfit::cli {

// What the columns mean, those of plans too.
std::string ShotLegend();

// Ends in a newline.
std::string ShotReportText(const ShotContext& context, bool has_legend = false);

// One line for each frame that could not be read, and for each light without a matrix in some
// frames of a mode: the frames, and why in the first of them.
std::vector<std::string> ShotErrors(const ShotContext& context);

}  // namespace lightfit::cli
