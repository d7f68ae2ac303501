// cli/tune.h
//
// `lightfit tune SCENE`: the matrices of fewest wrong pixels, searched by ray casting.
#pragma once

#include "cli/flags/tune_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareTune(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode. Files are written even when there is no matrix
// for some of the lights.
int RunTune(const TuneFlags& flags);

}  // namespace lightfit::cli
