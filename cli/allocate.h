// cli/allocate.h
//
// `lightfit allocate READBACK.exr` or `--summary FILE...`: how large the shadow maps of several
// lights should be, for one frame or for all that were summarised.
#pragma once

#include "cli/flags/allocate_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareAllocate(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode. Files are written even when some lights have
// no map.
int RunAllocate(const AllocateFlags& flags);

}  // namespace lightfit::cli
