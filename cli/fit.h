// cli/fit.h
//
// `lightfit fit READBACK.exr`: matrices, figures and a picture for the lights of one read-back.
#pragma once

#include "cli/flags/fit_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareFit(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode. Files are written even when some lights have
// no matrix.
int RunFit(const FitFlags& flags);

}  // namespace lightfit::cli
