#include "cli/flags/fit_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "cli/flags/choice_option.h"
#include "cli/flags/number_checks.h"
#include "cli/flags/readback_flags.h"
#include "cli/flags/size_flags.h"
#include "io/summary_file.h"

namespace lightfit::cli {
namespace {

constexpr char kInputGroup[] = "Input";
constexpr char kCameraGroup[] = "Camera";
constexpr char kMethodGroup[] = "Method";

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit fit 0001.exr --lights scene.json --json matrices.json --picture gain.png\n"
    "  lightfit fit 0001.exr --light sun=sun:-0.93,-0.24,-0.27 --map 2048x1024 --clip direct3d\n"
    "  lightfit fit 0001.exr --lights scene.json --maps 4 --texels 2048x2048 --json maps.json\n"
    "  lightfit fit 0001.exr --lights scene.json --only key --as-published\n"
    "  lightfit fit 0001.exr --lights scene.json --csv lights.csv --footprint pixels.exr\n"
    "  lightfit fit --summary part1.summary part2.summary --json shot.json\n"
    "\n"
    "Units: positions and depth in world units, maps in texels, images in pixels.\n"
    "The read-back holds a depth channel, Z or one called depth, and one channel shadow.LIGHT per\n"
    "light, above 0.5 where that light is blocked; facing.LIGHT, above 0.5 where a surface faces "
    "the\n"
    "light, is optional; the camera comes from worldToCamera and worldToNDC in its header. They "
    "may\n"
    "lie in several parts; what was taken stands in the first line.";

void DeclareInput(CLI::App* app, FitFlags* flags) {
  const std::string group = kInputGroup;
  app->add_option("readback", flags->readback_path, "OpenEXR file with depth and shadow channels")
      ->type_name("READBACK.exr");
  app->add_option("--summary",
                  flags->summary_paths,
                  "Instead of a read-back: fit one map per light to the sum of these files of "
                  "lightfit summarize")
      ->type_name("FILE")
      ->group(group);
  DeclareLightFlags(app, &flags->lights, group);
  DeclareOnlyFlag(app, group, &flags->only);
  DeclareReadbackFlags(app, group, flags);
  DeclareCoverReadbackFlag(app, group, flags);
}

// What `fit` asks of a read-back beside its channels.
void CheckNeedsOfFit(const CLI::App& app, const FitFlags& flags) {
  if (flags.summary_paths.empty()) return;
  if (app.count("--picture") > 0) {
    throw CLI::ValidationError("--picture",
                               "needs the pixels of a read-back, and a summary has none; draw one "
                               "frame with lightfit fit READBACK.exr --picture");
  }
  for (const char* flag : {"--csv", "--footprint"}) {
    if (app.count(flag) == 0) continue;
    throw CLI::ValidationError(flag,
                               "needs the pixels of a read-back, and a summary has none; name one "
                               "frame, lightfit fit READBACK.exr, or with --csv run lightfit shot");
  }
  if (app.count("--as-published") > 0) {
    throw CLI::ValidationError("--as-published",
                               "goes through the samples one by one, and a summary has their sums "
                               "only; --search line runs on those");
  }
}

void DeclareMethod(CLI::App* app, FitFlags* flags) {
  DeclareMethodFlags(app, &flags->options);
  app->add_flag(
         "--as-published", flags->as_published, "Chong and Gortler's Algorithm 1 to the letter")
      ->excludes(app->get_option("--search"))
      ->excludes(app->get_option("--affine"))
      ->excludes(app->get_option("--metric"))
      ->excludes(app->get_option("--cover"))
      ->excludes(app->get_option("--border"))
      ->group(kMethodGroup);
}

void DeclareOutput(CLI::App* app, FitFlags* flags) {
  const std::string group = "Output";
  app->add_option("--json", flags->json_path, "Write the matrices and figures to this file")
      ->type_name("FILE.json")
      ->group(group);
  app->add_option("--picture", flags->picture_path, "Draw before and after, per light")
      ->type_name("FILE.png")
      ->group(group);
  app->add_option("--csv", flags->csv_path, "Write one line for each light, with all figures")
      ->type_name("FILE.csv")
      ->group(group);
  app->add_option("--footprint",
                  flags->footprint_path,
                  "Write an image of each light's footprints and of the wrong pixels foretold, "
                  "channels footprint.LIGHT and wrong.LIGHT")
      ->type_name("FILE.exr")
      ->group(group);
  DeclareLegendFlag(app, group, &flags->legend);
  app->add_flag("-q,--quiet", flags->quiet, "No table and no progress; errors and warnings only")
      ->group(group);
}

}  // namespace

void DeclareOnlyFlag(CLI::App* app, const std::string& group, std::vector<std::string>* only) {
  app->add_option("--only", *only, "This light only (may be repeated)")
      ->type_name("LIGHT")
      ->expected(1)
      ->take_all()
      ->group(group);
}

void DeclareMethodFlags(CLI::App* app, FitOptions* options) {
  AddChoice(
      app, "--search", SearchWords(), &options->search, "How the projective axis is found [global]")
      ->group(kMethodGroup);
  AddChoice(app,
            "--affine",
            AffineWords(),
            &options->affine,
            "How the map is laid around what it covers [parallelogram]")
      ->group(kMethodGroup);
  DeclareSummingFlags(app, options);
  AddChoice(app,
            "--border",
            BorderWords(),
            &options->border,
            absl::StrCat("What look-ups outside the map find: light, shadow, or of each light what "
                         "makes fewer pixels wrong (border in the JSON file) [",
                         WordFor(BorderWords(), options->border),
                         "]"))
      ->group(kMethodGroup);
  app->add_option("--margin-percent",
                  options->margin_percent,
                  "The map reaches this much beyond what it covers on every side [1]")
      ->type_name("PERCENT")
      ->check(NumberIn(0.0, 100.0))
      ->group(kMethodGroup);
  app->add_option("--min-samples",
                  options->samples.min_samples,
                  "With fewer usable shadow-edge pixels than this a light gets its focused map [8]")
      ->type_name("COUNT")
      ->check(CLI::PositiveNumber)
      ->group(kMethodGroup);
}

void DeclareSummingFlags(CLI::App* app, FitOptions* options) {
  AddChoice(app,
            "--metric",
            MetricWords(),
            &options->metric,
            "What is summed over the shadow edges; -edge: across the edge only [l1-edge]")
      ->group(kMethodGroup);
  AddChoice(app,
            "--cover",
            CoverWords(),
            &options->cover,
            "What the map has room for: surfaces that the border would get wrong, with a lit one "
            "those in shadow; or all receivers in view [shadowed]")
      ->group(kMethodGroup);
}

void DeclareMapFlags(CLI::App* app, const std::string& group, FitFlags* flags) {
  app->add_option_function<std::string>(
         "--map",
         [flags](const std::string& text) {
           const absl::StatusOr<MapSize> map = ParseMapSize(text);
           if (!map.ok()) throw CLI::ValidationError("--map", std::string(map.status().message()));
           flags->map = *map;
         },
         "Size of the shadow map in texels [1024x1024]")
      ->type_name("WIDTHxHEIGHT")
      ->group(group);
  DeclareClipFlag(app, group, &flags->clip);
}

void DeclareClipFlag(CLI::App* app, const std::string& group, ClipConvention* clip) {
  AddChoice(
      app, "--clip", ClipWords(), clip, "Clip space of clipFromWorld in the JSON file [vulkan]")
      ->group(group);
}

void DeclareLegendFlag(CLI::App* app, const std::string& group, bool* legend) {
  app->add_flag("--legend", *legend, "Say below the table what its columns mean")->group(group);
}

void DeclareFitFlags(CLI::App* app, FitFlags* flags) {
  flags->options.border = BorderChoice::kAutomatic;
  DeclareInput(app, flags);
  DeclareCameraFlags(app, kCameraGroup, flags);
  DeclareMapFlags(app, "Map", flags);
  DeclarePlanFlags(app, flags->map, &flags->plan);
  DeclareMethod(app, flags);
  DeclareOutput(app, flags);
  app->footer(kExamples);
  app->callback([app, flags] {
    flags->has_metric = app->count("--metric") > 0;
    flags->has_cover = app->count("--cover") > 0;
    flags->has_border = app->count("--border") > 0;
    CheckSource(*app, *flags, {kInputGroup, kCameraGroup});
    CheckNeedsOfFit(*app, *flags);
    CheckPlanFlags(*app, flags->map, &flags->plan);
  });
}

void CheckIsReadback(const CLI::App& app, const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw CLI::ValidationError(path,
                               absl::StrCat("is a folder: for all its frames lightfit shot ",
                                            path,
                                            "; lightfit ",
                                            app.get_name(),
                                            " takes one read-back of them"));
  }
  if (IsSummaryFile(path)) {
    throw CLI::ValidationError(
        path, absl::StrCat("is a summary: lightfit ", app.get_name(), " --summary ", path));
  }
}

void CheckSource(const CLI::App& app,
                 const FitFlags& flags,
                 const std::vector<std::string>& readback_groups) {
  if (!flags.readback_path.empty()) CheckIsReadback(app, flags.readback_path);
  if (flags.readback_path.empty() == flags.summary_paths.empty()) {
    throw CLI::ValidationError(app.get_name(),
                               "want a read-back or --summary, one of the two; lightfit summarize "
                               "adds a read-back to summaries");
  }
  if (flags.summary_paths.empty()) return;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "--summary" || name == "--only") continue;
    if (std::find(readback_groups.begin(), readback_groups.end(), option->get_group()) ==
        readback_groups.end()) {
      continue;
    }
    throw CLI::ValidationError(name,
                               "is about a read-back; leave it out with --summary, whose files "
                               "hold the lights and what their samples came to");
  }
}

}  // namespace lightfit::cli
