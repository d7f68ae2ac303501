#include "cli/flags/allocate_flags.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/number.h"
#include "base/suggest.h"
#include "cli/flags/choices.h"
#include "cli/flags/readback_flags.h"
#include "cli/flags/size_flags.h"

namespace lightfit::cli {
namespace {

constexpr char kInputGroup[] = "Input";
constexpr char kCameraGroup[] = "Camera";

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit allocate 0001.exr --lights scene.json --budget 4096x4096 --json maps.json\n"
    "  lightfit allocate 0001.exr --lights scene.json --budget 2048x2048 --power-of-two "
    "--weight sun=2\n"
    "  lightfit allocate 0001.exr --lights scene.json --tolerance rms:1.0\n"
    "  lightfit allocate 0001.exr --lights scene.json --tolerance p99:3\n"
    "  lightfit allocate 0001.exr --lights scene.json --tolerance p99:4 --image 1920x1080 --only "
    "key\n"
    "  lightfit allocate --summary shot.summary --budget 4096x4096 --json maps.json\n"
    "  lightfit allocate 0001.exr --lights scene.json --budget 4096x4096 --maps 4 --json "
    "maps.json\n"
    "\n"
    "A budget is a number of texels: 4096x4096 are 16777216 of them, for all maps together. Each\n"
    "map is a texture of its own; they are not packed into one image of that shape.\n"
    "A tolerance bounds how far one texel reaches on the screen at the shadow edges, in pixels of\n"
    "the final image: in the root mean square (rms), for 99 % of the edge pixels of the read-back\n"
    "(p99), or for all of them (worst). It holds for those pixels, each measured; nothing is\n"
    "promised in between. Where no map keeps it the message says what could be kept. The fit then "
    "minimises that figure, so that --metric does not apply.\n"
    "Summaries of a whole shot take a budget, or where they were summed with --metric l2 an rms\n"
    "tolerance, of all frames' edge pixels together and in pixels of the read-backs. Sums of the\n"
    "l1 metrics weigh samples by square maps; to weigh them by the maps found, run lightfit\n"
    "summarize once more with --weigh-by maps.json, and allocate again.\n"
    "Exit code 3: some light has no map, or no map within the limits keeps the tolerance.";

const Words<Tolerance::Kind>& ToleranceWords() {
  static const Words<Tolerance::Kind> words = {{"rms", Tolerance::Kind::kRms},
                                               {"p99", Tolerance::Kind::kP99},
                                               {"worst", Tolerance::Kind::kWorst}};
  return words;
}

// An option whose words `parse` understands, or says why not.
template <typename Parse, typename Use>
CLI::Option* AddParsed(CLI::App* app,
                       const std::string& flag,
                       const Parse& parse,
                       const Use& use,
                       const std::string& meaning) {
  return app->add_option_function<std::string>(
      flag,
      [=](const std::string& text) {
        auto value = parse(text);
        if (!value.ok()) throw CLI::ValidationError(flag, std::string(value.status().message()));
        use(*std::move(value));
      },
      meaning);
}

// A single number would be taken for the width as likely as for a square.
absl::StatusOr<MapSize> ParseImageSize(const std::string& text) {
  if (ParseSides(text).has_value()) return ParseMapSize(text);
  return absl::InvalidArgumentError(
      absl::StrCat("\"", text, "\" is no size, want WIDTHxHEIGHT in pixels such as 1920x1080"));
}

void DeclareGoal(CLI::App* app, AllocateFlags* flags) {
  const std::string group = "Goal (one of --budget and --tolerance)";
  CLI::Option* budget = AddParsed(
      app,
      "--budget",
      ParseTexels,
      [flags](int64_t texels) { flags->budget_texels = texels; },
      "Texels of all maps together, as a size or a number: the split with the least energy");
  budget->type_name("WIDTHxHEIGHT|TEXELS")->group(group);
  CLI::Option* tolerance = AddParsed(
      app,
      "--tolerance",
      ParseTolerance,
      [flags](const Tolerance& value) { flags->tolerance = value; },
      "Footprint of a texel at the shadow edges, pixels of the final image: the smallest maps that "
      "keep it");
  tolerance->type_name("rms:PIXELS|p99:PIXELS|worst:PIXELS")
      ->excludes(budget)
      ->excludes(app->get_option("--metric"))
      ->group(group);
  AddParsed(
      app,
      "--image",
      ParseImageSize,
      [flags](MapSize image) { flags->image = image; },
      "Size of the final image, pixels; where its shape is not the read-back's, the larger ratio "
      "of the two counts [the read-back's]")
      ->type_name("WIDTHxHEIGHT")
      ->group(group);
  app->add_option_function<std::vector<std::string>>(
         "--weight",
         [flags](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const auto weight = ParseWeight(text);
             if (!weight.ok()) {
               throw CLI::ValidationError("--weight", std::string(weight.status().message()));
             }
             flags->weights[weight->first] = weight->second;
           }
         },
         "What a light's energy counts in the sum that a budget makes least (may be repeated) [1]")
      ->type_name("LIGHT=NUMBER")
      ->expected(1)
      ->take_all()
      ->excludes(tolerance)
      ->group(group);
}

void CheckGoal(const AllocateFlags& flags) {
  if (!flags.budget_texels.has_value() && !flags.tolerance.has_value()) {
    throw CLI::RequiredError("--budget WIDTHxHEIGHT or --tolerance rms:PIXELS");
  }
  if (flags.fit.summary_paths.empty()) return;
  if (flags.image.has_value()) {
    throw CLI::ValidationError("--image",
                               "needs the size of the read-back, and a summary has none; leave it "
                               "out and count in pixels of the read-backs: for an image twice as "
                               "wide, half the tolerance");
  }
  if (flags.tolerance.has_value() && flags.tolerance->kind != Tolerance::Kind::kRms) {
    throw CLI::ValidationError("--tolerance",
                               "p99 and worst go through the samples one by one, and a summary has "
                               "their sums only; want rms:PIXELS, or a read-back in place of "
                               "--summary");
  }
}

// Several maps for each light: the budget is theirs in all.
void CheckPlans(const CLI::App& app, AllocateFlags* flags) {
  PlanFlags* plan = &flags->fit.plan;
  if (plan->max_maps > 1 && flags->tolerance.has_value()) {
    throw CLI::ValidationError("--maps",
                               "divides a budget among lights and maps, --budget; a tolerance is "
                               "for single maps");
  }
  if (plan->max_maps == 1) {
    if (app.count("--guard") == 0) return;
    throw CLI::ValidationError("--guard", "is for several maps, --maps 2 or more");
  }
  CheckNotUsedByPlans(app);
  plan->has_rules = HasSizeFlags(app);
  plan->rules = flags->rules;
  plan->texels = *flags->budget_texels;
}

absl::Status NoTolerance(const std::string& text) {
  return absl::InvalidArgumentError(
      absl::StrCat("\"",
                   text,
                   "\" is no tolerance, want rms:PIXELS, p99:PIXELS or worst:PIXELS, such as "
                   "rms:1.0"));
}

}  // namespace

void DeclareAllocateFlags(CLI::App* app, AllocateFlags* flags) {
  FitFlags* fit = &flags->fit;
  const std::string input = kInputGroup;
  app->add_option("readback", fit->readback_path, "OpenEXR file with depth and shadow channels")
      ->type_name("READBACK.exr");
  app->add_option("--summary",
                  fit->summary_paths,
                  "Instead of a read-back: sizes for all the frames in these files of lightfit "
                  "summarize, which have the lights in them")
      ->type_name("FILE")
      ->group(input);
  DeclareLightFlags(app, &fit->lights, input);
  DeclareOnlyFlag(app, input, &fit->only);
  DeclareReadbackFlags(app, input, fit);
  DeclareCameraFlags(app, kCameraGroup, fit);
  DeclareMethodFlags(app, &fit->options);
  DeclareGoal(app, flags);
  DeclareSizeFlags(app, "Sizes of maps", &flags->rules);
  DeclareMapsFlags(app, &fit->plan);
  const std::string output = "Output";
  DeclareMapFlags(app, output, fit);
  app->remove_option(app->get_option("--map"));  // sizes are what is asked for
  app->add_option("--json", fit->json_path, "Write the sizes, matrices and figures to this file")
      ->type_name("FILE.json")
      ->group(output);
  DeclareLegendFlag(app, output, &fit->legend);
  app->add_flag("-q,--quiet", fit->quiet, "No table and no progress; errors and warnings only")
      ->group(output);
  app->footer(kExamples);
  app->callback([app, flags] {
    flags->fit.has_metric = app->count("--metric") > 0;
    flags->fit.has_cover = app->count("--cover") > 0;
    flags->fit.has_border = app->count("--border") > 0;
    CheckSource(*app, flags->fit, {kInputGroup, kCameraGroup});
    CheckGoal(*flags);
    CheckPlans(*app, flags);
  });
}

absl::StatusOr<Tolerance> ParseTolerance(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  Tolerance tolerance;
  if (parts.size() != 2 || !absl::SimpleAtod(parts[1], &tolerance.limit_px)) {
    return NoTolerance(text);
  }
  if (!(tolerance.limit_px > 0.0) || !std::isfinite(tolerance.limit_px)) {
    return absl::InvalidArgumentError(absl::StrCat(text, ": want a number of pixels above 0"));
  }
  for (const auto& [word, kind] : ToleranceWords()) {
    if (word != parts[0]) continue;
    tolerance.kind = kind;
    return tolerance;
  }
  return NoTolerance(text);
}

std::string ToleranceText(const Tolerance& tolerance) {
  const std::string limit = absl::StrCat(" at most ", FigureText(tolerance.limit_px), " pixels");
  switch (tolerance.kind) {
    case Tolerance::Kind::kRms:
      return "rms footprint" + limit;
    case Tolerance::Kind::kP99:
      return "99 % of the footprints" + limit;
    case Tolerance::Kind::kWorst:
      break;
  }
  return "every footprint" + limit;
}

std::string ToleranceThatHolds(const Tolerance& tolerance, double reached_px) {
  // Three digits, rounded up.
  const double unit = std::pow(10.0, std::floor(std::log10(reached_px)) - 2.0);
  const double limit = std::ceil(reached_px / unit) * unit;
  return absl::StrFormat("%s:%.3g", WordFor(ToleranceWords(), tolerance.kind), limit);
}

absl::StatusOr<std::pair<std::string, double>> ParseWeight(const std::string& text) {
  const size_t equals = text.rfind('=');
  double weight = 0.0;
  if (equals == std::string::npos || equals == 0 ||
      !absl::SimpleAtod(text.substr(equals + 1), &weight)) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is no weight, want LIGHT=NUMBER such as sun=2"));
  }
  if (!(weight > 0.0) || !std::isfinite(weight)) {
    return absl::InvalidArgumentError(
        absl::StrCat(text, ": want a number above 0; --only leaves a light out altogether"));
  }
  return std::make_pair(text.substr(0, equals), weight);
}

}  // namespace lightfit::cli
