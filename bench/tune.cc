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
#include "bench/scene_run.h"
#include "jobs/compare/stage.h"

namespace lightfit {
namespace {

struct Arguments {
  SceneArguments scenes = {.num_lights = 3, .seed = 41};
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
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
  if (!caster.ok()) return caster.status();
  constexpr int kReadback = 180;
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
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
    Progress progress(arguments.scenes.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments.scenes, [&](size_t scene) {
      return TuneScene(SceneCases()[scene], arguments, progress, &all, &csv);
    });
    if (!status.ok()) return status;
  }
  Print("all scenes", all);
  std::printf("\n%s", csv.c_str());
  const std::string& path = arguments.scenes.csv_path;
  return path.empty() ? absl::OkStatus() : WriteTextFileAtomically(path, csv);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  arguments.tune.evaluations = 200;
  CLI::App app("How far fits are from the fewest wrong pixels there are.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  app.add_option("--evaluations", arguments.tune.evaluations, "Maps tried for each light")
      ->capture_default_str();
  lightfit::DeclareScenes(&app, &arguments.scenes);
  lightfit::DeclareCsv(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("tune", lightfit::Run(arguments));
}
