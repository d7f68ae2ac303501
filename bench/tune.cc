// bench/tune.cc : how far fits are from the fewest wrong pixels there are.
//
// In:   the scenes of bench/scene_set.h, a few lights each in turn over three cameras, drawn with a
//       seed that nothing was chosen by; 750x750 screen, 400x400 maps, 180x180 read-backs.
// Out:  a line for each light: wrong pixels of the fit and of the best map that jobs/tune finds
//       from it on, at the phases of the search and at others; per scene and over all the fit over
//       that limit, in total and in the geometric mean. --csv: the same lines.
//
// Scenes whose file is absent are named and left out. About 7 minutes on two cores. The limit is as
// good as the search: more --evaluations find a little less.
#include "jobs/tune/tune.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/csv.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "bench/scene_set.h"
#include "jobs/compare/stage.h"

namespace lightfit {
namespace {

struct Arguments {
  int num_lights = 3;
  uint64_t seed = 41;
  std::string folder = DefaultSceneFolder();
  std::string only;
  std::string csv_path;
  TuneOptions tune;
};

void AppendRow(const std::string& view, const TunedLight& light, std::string* csv) {
  absl::StrAppend(csv, CsvField(view), ",", CsvField(light.light.name), ",");
  if (light.status.ok()) {
    absl::StrAppend(csv,
                    light.fit.wrong,
                    ",",
                    light.tuned.wrong,
                    ",",
                    light.fit.check,
                    ",",
                    light.tuned.check,
                    ",",
                    light.evaluations,
                    ",\n");
  } else {
    absl::StrAppend(csv, ",,,,,", CsvField(std::string(light.status.message())), "\n");
  }
}

void Print(const std::string& title, const std::vector<TunedLight>& lights) {
  const TuneTotals totals = TotalsOf(lights);
  const auto ratio = [](int64_t fit, int64_t limit) {
    return (static_cast<double>(fit) + 1.0) / (static_cast<double>(limit) + 1.0);
  };
  std::printf(
      "%-20s %3d lights, fit over limit: total %.3f, mean %.3f; at other phases %.3f, %.3f\n",
      title.c_str(),
      totals.num_lights,
      ratio(totals.fit_wrong, totals.tuned_wrong),
      totals.mean_ratio,
      ratio(totals.fit_check, totals.tuned_check),
      totals.mean_check_ratio);
  std::fflush(stdout);
}

absl::Status TuneScene(const SceneCase& scene,
                       const Arguments& arguments,
                       Progress& progress,
                       std::vector<TunedLight>* all,
                       std::string* csv) {
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.folder);
  if (!caster.ok()) return caster.status();
  constexpr int kReadback = 180;
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.num_lights, arguments.seed);
  std::vector<TunedLight> tuned;
  for (size_t i = 0; i < lights.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", lights[i].name));
    Journal journal;
    // Few lights a scene see all of its views, too.
    const size_t view = i % stages->size();
    absl::StatusOr<TunedLight> light =
        TuneLight((*stages)[view], lights[i], arguments.tune, static_cast<int>(i), &journal);
    if (!light.ok()) return light.status();
    AppendRow(absl::StrCat(scene.name, "/", view + 1), *light, csv);
    tuned.push_back(*std::move(light));
    progress.Advance();
  }
  Print(scene.name, tuned);
  all->insert(all->end(), tuned.begin(), tuned.end());
  return absl::OkStatus();
}

absl::Status Run(const Arguments& arguments) {
  if (absl::Status status = ValidateTuneOptions(arguments.tune); !status.ok()) return status;
  std::vector<TunedLight> all;
  std::string csv = "view,light,fit,limit,fit_other_phases,limit_other_phases,evaluations,note\n";
  {
    Progress progress(arguments.num_lights * static_cast<int>(SceneCases().size()));
    for (const SceneCase& scene : SceneCases()) {
      if (!arguments.only.empty() && scene.name != arguments.only) continue;
      absl::Status status = TuneScene(scene, arguments, progress, &all, &csv);
      if (absl::IsNotFound(status)) {
        std::printf("%s left out: %s\n", scene.name.c_str(), std::string(status.message()).c_str());
        continue;
      }
      if (!status.ok()) return status;
    }
  }
  Print("all scenes", all);
  std::printf("\n%s", csv.c_str());
  return arguments.csv_path.empty() ? absl::OkStatus()
                                    : WriteTextFileAtomically(arguments.csv_path, csv);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  arguments.tune.evaluations = 200;
  CLI::App app("How far fits are from the fewest wrong pixels there are.");
  app.add_option("--lights", arguments.num_lights, "Per scene")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the lights")->capture_default_str();
  app.add_option("--evaluations", arguments.tune.evaluations, "Maps tried for each light")
      ->capture_default_str();
  app.add_option("--scenes", arguments.folder, "Folder with the scene files")
      ->capture_default_str();
  app.add_option("--only", arguments.only, "One scene, by name");
  app.add_option("--csv", arguments.csv_path, "One row per light");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(arguments);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tune: %s\n", std::string(status.message()).c_str());
  return 1;
}
