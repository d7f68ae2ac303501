// cli/flags/plan_flags.h
//
// The options of `lightfit fit` about several maps for one light.
// In:   words; those that do not go together are refused while parsing (exit code 1).
// Out:  PlanFlags, and from the flags of the fit PlanOptions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "optimizer/sizing/map_sizes.h"
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
  MapSizeRules rules;      // of the sizes of maps
  bool has_rules = false;  // whether any of them was given
};

// Declares the rules of sizes, --multiple and so on.
void DeclareSizeFlags(CLI::App* app, const std::string& group, MapSizeRules* rules);
bool HasSizeFlags(const CLI::App& app);

// Declares --maps, --texels, --guard and the rules of sizes on `app`.
void DeclarePlanFlags(CLI::App* app, PlanFlags* flags);

// --maps and --guard alone.
void DeclareMapsFlags(CLI::App* app, PlanFlags* flags);

// Throws CLI::ValidationError where something was given that plans have no use for.
void CheckNotUsedByPlans(const CLI::App& app);

// The same where options do not go together; takes over --map.
void CheckPlanFlags(const CLI::App& app, FitFlags* flags);

// Nothing where one map of each light is wanted.
std::optional<PlanOptions> PlanOptionsOf(const FitFlags& flags);

}  // namespace lightfit::cli
