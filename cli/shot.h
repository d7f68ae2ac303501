// cli/shot.h
//
// `lightfit shot FOLDER`: matrices for all frames of a shot, per frame, tracked and once for all.
#pragma once

#include "cli/flags/shot_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareShot(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode.
int RunShotVerb(const ShotFlags& flags);

}  // namespace lightfit::cli
