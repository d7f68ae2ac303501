// cli/flags/scene_needs.h
//
// What a command line about a scene lacks, all of it at once.
// In:   SceneFlags, and what else the verb misses.
// Out:  InvalidArgument with every option that is to be added.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "cli/flags/scene_flags.h"

namespace lightfit::cli {

absl::Status CheckSceneNeeds(const SceneFlags& flags, std::vector<std::string> missing = {});

}  // namespace lightfit::cli
