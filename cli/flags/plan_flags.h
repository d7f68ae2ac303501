// cli/flags/plan_flags.h
//
// The options of `lightfit fit`, `shot` and `compare` about several maps for one light.
// In:   words; those that do not go together are refused while parsing (exit code 1).
// Out:  PlanFlags, and with the options of the fit PlanOptions.
#pragma once

#include <cstdint>
#include <optional>

#include "optimizer/sizing/map_sizes.h"
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
  MapSizeRules rules;      // of the sizes of maps
  bool has_rules = false;  // whether any of them was given
};

// Declares --maps, --texels, --guard and the rules of sizes on `app`, which has --map. All maps
// together have by default the texels of `one_map`, the default of --map.
void DeclarePlanFlags(CLI::App* app, MapSize one_map, PlanFlags* flags);

// --maps and --guard alone.
void DeclareMapsFlags(CLI::App* app, PlanFlags* flags);

// Throws CLI::ValidationError where something was given that plans have no use for.
void CheckNotUsedByPlans(const CLI::App& app);

// The same where options do not go together; takes over --map, which is `map`.
void CheckPlanFlags(const CLI::App& app, MapSize map, PlanFlags* flags);

// Nothing where one map of each light is wanted.
std::optional<PlanOptions> PlanOptionsOf(const PlanFlags& flags, const FitOptions& fit);

}  // namespace lightfit::cli
