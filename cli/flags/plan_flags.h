// cli/flags/plan_flags.h
//
// The options of `lightfit fit` about several maps for one light.
// In:   words; those that do not go together are refused while parsing (exit code 1).
// Out:  PlanFlags, and from the flags of the fit PlanOptions.
#pragma once

#include <cstdint>
#include <optional>

#include "partition/plan_options.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct FitFlags;

struct PlanFlags {
  int max_maps = 1;
  std::optional<int64_t> texels;  // of all maps of a light
  std::optional<MapSize> each;    // --map, where it was given
  double guard_texels = 0.0;
};

// Declares --maps, --texels and --guard on `app`.
void DeclarePlanFlags(CLI::App* app, PlanFlags* flags);

// Throws CLI::ValidationError where options do not go together; takes over --map.
void CheckPlanFlags(const CLI::App& app, FitFlags* flags);

// Nothing where one map of each light is wanted.
std::optional<PlanOptions> PlanOptionsOf(const FitFlags& flags);

}  // namespace lightfit::cli
