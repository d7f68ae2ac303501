// cli/flags/plan_flags.h
//
// The options of `lightfit fit`, `shot` and `compare` about several maps for one light.
// In:   words; those that do not go together are refused while parsing (exit code 1).
// Out:  PlanFlags, and with the options of the fit PlanOptions.
#pragma once

#include <cstdint>
#include <optional>

#include "partition/plan_options.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct PlanFlags {
  int max_maps = 1;
  int64_t texels = PlanOptions().texels;  // of all maps of a light
  std::optional<MapSize> each;            // --map, where it was given
  double guard_texels = 0.0;
};

// Declares --maps, --texels and --guard on `app`, which has --map. All maps together have by
// default the texels of `one_map`, the default of --map.
void DeclarePlanFlags(CLI::App* app, MapSize one_map, PlanFlags* flags);

// Throws CLI::ValidationError where options do not go together; takes over --map, which is `map`.
void CheckPlanFlags(const CLI::App& app, MapSize map, PlanFlags* flags);

// Nothing where one map of each light is wanted.
std::optional<PlanOptions> PlanOptionsOf(const PlanFlags& flags, const FitOptions& fit);

}  // namespace lightfit::cli
