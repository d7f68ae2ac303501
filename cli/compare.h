// cli/compare.h
//
// `lightfit compare SCENE|READBACK.exr`: every method side by side, on one light or many.
#pragma once

#include "cli/flags/compare_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareCompare(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode. Files are written even when lightfit has no
// matrix for some of the lights.
int RunCompare(const CompareFlags& flags);

}  // namespace lightfit::cli
