// cli/fit_summary.h
//
// `lightfit fit --summary FILE...`: one map per light for all the frames that were summarised.
#pragma once

#include "cli/flags/fit_flags.h"

namespace lightfit::cli {

// Does what `flags` ask for and returns an ExitCode. The JSON file is written even when some lights
// have no matrix, and is the same in whatever order the files are named.
int RunFitSummary(const FitFlags& flags);

}  // namespace lightfit::cli
