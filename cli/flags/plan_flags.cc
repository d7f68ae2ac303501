#include "cli/flags/plan_flags.h"

#include <CLI/CLI.hpp>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/flags/number_checks.h"
#include "cli/flags/size_flags.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/plan.h"

namespace lightfit::cli {
namespace {

constexpr char kGroup[] = "Several maps for one light";

// What a plan has no use for, and why.
struct Unused {
  const char* flag;
  const char* reason;
};
constexpr Unused kUnusedByPlans[] = {
    {"--as-published", "the published algorithm has one map"},
    {"--search", "the maps of a plan are searched in one way"},
    {"--affine", "the maps of a plan are parallelograms of least energy"},
    {"--summary", "a plan is fitted to the pixels of a read-back, and a summary has none"},
    {"--replace-below", "a plan is kept by its energy; --stability says for how much of it"},
    {"--rounds", "the plan of a shot is fitted to its samples, and weighs them as it goes"},
};

// Verbs have some of the options each.
size_t CountOf(const CLI::App& app, const char* flag) {
  const CLI::Option* option = app.get_option_no_throw(flag);
  return option != nullptr ? option->count() : 0;
}

}  // namespace

void DeclareMapsFlags(CLI::App* app, PlanFlags* flags) {
  app->add_option(
         "--maps",
         flags->max_maps,
         "At most so many maps for each light, 1 to 32, of which every pixel asks the "
         "finest that holds it; fewer where fewer pixels are foretold to be wrong. With --map all "
         "of them have that size [1]")
      ->type_name("COUNT")
      ->check(CLI::Range(1, kMaxPlanMaps))
      ->group(kGroup);
  app->add_option("--guard",
                  flags->guard_texels,
                  "With --maps: half the width of the shadow filter, texels; look-ups keep so far "
                  "from the edges of every map [0]")
      ->type_name("TEXELS")
      ->check(NumberIn(0.0, 0.5 * kMaxMapSide))
      ->group(kGroup);
}

void DeclarePlanFlags(CLI::App* app, MapSize one_map, PlanFlags* flags) {
  flags->texels = TexelsOf(one_map);
  DeclareMapsFlags(app, flags);
  app->add_option_function<std::string>(
         "--texels",
         [flags](const std::string& text) {
           const absl::StatusOr<int64_t> texels = ParseTexels(text);
           if (!texels.ok()) {
             throw CLI::ValidationError("--texels", std::string(texels.status().message()));
           }
           flags->texels = *texels;
         },
         absl::StrCat("With --maps: texels of all maps of one light together, as a size or a "
                      "number; never more, and sizes may differ [",
                      one_map.width,
                      "x",
                      one_map.height,
                      ", as one map has]"))
      ->type_name("WIDTHxHEIGHT|TEXELS")
      ->group(kGroup);
  DeclareSizeFlags(app, "Sizes of several maps [any, unless one of these is given]", &flags->rules);
}

void CheckNotUsedByPlans(const CLI::App& app) {
  for (const Unused& unused : kUnusedByPlans) {
    if (CountOf(app, unused.flag) == 0) continue;
    throw CLI::ValidationError("--maps",
                               absl::StrCat("does not go with ", unused.flag, ": ", unused.reason));
  }
}

void CheckPlanFlags(const CLI::App& app, MapSize map, PlanFlags* flags) {
  if (flags->max_maps == 1) {
    for (const char* flag :
         {"--texels", "--guard", "--multiple", "--power-of-two", "--min-side", "--max-side"}) {
      if (CountOf(app, flag) == 0) continue;
      throw CLI::ValidationError(
          flag, "is for several maps, --maps 2 or more; of a single map say the size, --map");
    }
    return;
  }
  CheckNotUsedByPlans(app);
  flags->has_rules = HasSizeFlags(app);
  if (app.count("--map") == 0) return;
  if (flags->has_rules) {
    throw CLI::ValidationError("--map",
                               "is the size of every map, and --multiple, --power-of-two, "
                               "--min-side and --max-side choose sizes: give one or the other");
  }
  if (app.count("--texels") > 0) {
    throw CLI::ValidationError("--texels",
                               "is what all maps of a light have together, and --map the size of "
                               "each: give one of the two");
  }
  flags->each = map;
}

std::optional<PlanOptions> PlanOptionsOf(const PlanFlags& flags, const FitOptions& fit) {
  if (flags.max_maps == 1) return std::nullopt;
  PlanOptions options;
  options.fit = fit;
  options.max_maps = flags.max_maps;
  options.texels = flags.texels;
  options.each = flags.each;
  if (flags.has_rules) options.sizes = flags.rules;
  options.guard_texels = flags.guard_texels;
  return options;
}

}  // namespace lightfit::cli
