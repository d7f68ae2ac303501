#include "cli/flags/plan_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/flags/allocate_flags.h"
#include "cli/flags/fit_flags.h"
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
    {"--cover-readback", "plans do not look at a finer read-back yet"},
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

void DeclarePlanFlags(CLI::App* app, PlanFlags* flags) {
  app->add_option(
         "--maps",
         flags->max_maps,
         "At most so many maps for each light, 1 to 32, of which every pixel asks the "
         "finest that holds it; fewer where fewer pixels are foretold to be wrong. With --map all "
         "of them have that size [1]")
      ->type_name("COUNT")
      ->check(CLI::Range(1, kMaxPlanMaps))
      ->group(kGroup);
  app->add_option_function<std::string>(
         "--texels",
         [flags](const std::string& text) {
           const absl::StatusOr<int64_t> texels = ParseTexels(text);
           if (!texels.ok()) {
             throw CLI::ValidationError("--texels", std::string(texels.status().message()));
           }
           flags->texels = *texels;
         },
         "With --maps: texels of all maps of one light together, as a size or a number; never "
         "more, "
         "and sizes may differ [1024x1024, as one map has]")
      ->type_name("WIDTHxHEIGHT|TEXELS")
      ->group(kGroup);
  app->add_option("--guard",
                  flags->guard_texels,
                  "With --maps: half the width of the shadow filter, texels; look-ups keep so far "
                  "from the edges of every map [0]")
      ->type_name("TEXELS")
      ->check(CLI::Range(0.0, 0.5 * kMaxMapSide))
      ->group(kGroup);
}

void CheckPlanFlags(const CLI::App& app, FitFlags* flags) {
  if (flags->plan.max_maps == 1) {
    for (const char* flag : {"--texels", "--guard"}) {
      if (app.count(flag) == 0) continue;
      throw CLI::ValidationError(
          flag, "is for several maps, --maps 2 or more; of a single map say the size, --map");
    }
    return;
  }
  for (const Unused& unused : kUnusedByPlans) {
    if (CountOf(app, unused.flag) == 0) continue;
    throw CLI::ValidationError("--maps",
                               absl::StrCat("does not go with ", unused.flag, ": ", unused.reason));
  }
  if (app.count("--map") == 0) return;
  if (flags->plan.texels.has_value()) {
    throw CLI::ValidationError("--texels",
                               "is what all maps of a light have together, and --map the size of "
                               "each: give one of the two");
  }
  flags->plan.each = flags->map;
  if (2.0 * flags->plan.guard_texels < std::min(flags->map.width, flags->map.height)) return;
  throw CLI::ValidationError("--guard",
                             absl::StrCat(flags->plan.guard_texels,
                                          " on every side leaves nothing of maps of --map ",
                                          flags->map.width,
                                          "x",
                                          flags->map.height,
                                          " texels"));
}

std::optional<PlanOptions> PlanOptionsOf(const FitFlags& flags) {
  if (flags.plan.max_maps == 1) return std::nullopt;
  PlanOptions options;
  options.fit = flags.options;
  options.max_maps = flags.plan.max_maps;
  options.texels = flags.plan.texels.value_or(TexelsOf(FitFlags().map));
  options.each = flags.plan.each;
  options.guard_texels = flags.plan.guard_texels;
  return options;
}

}  // namespace lightfit::cli
