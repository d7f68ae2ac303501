// bench/scenes.cc : wrong shadow pixels of every method on real scenes.
//
// In:   the scenes of bench/scene_set.h, 100 lights each in turn over three cameras, two thirds
// suns
//       and one third lamps; 750x750 screen, 400x400 maps, 180x180 read-backs; counts are means
//       over 4 phases.
// Out:  per scene and over all: totals, means and ratios to ours under ideal and practical bias;
// the
//       lights on which ours is behind. --csv: one row per light.
//
// Scenes whose file is absent are named and left out. About 20 minutes on two cores.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/progress.h"
#include "bench/scene_run.h"
#include "bench/wrong_pixel_table.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"

namespace lightfit {
namespace {

struct Arguments {
  SceneArguments scenes = {.num_lights = 100, .seed = 1};
  CompareOptions compare;
};

// Those that have a matrix for lamps too.
const std::vector<std::string> kMethods = {
    kLightfitName, kLineName, kAsPublishedName, "focused", "lispsm", "lispsm-simple", "standard"};

absl::Status AddScene(const SceneCase& scene,
                      const Arguments& arguments,
                      Progress& progress,
                      const std::vector<WrongPixelTable*>& tables) {
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
  if (!caster.ok()) return caster.status();
  constexpr int kReadback = 180;
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
  for (size_t i = 0; i < lights.size(); ++i) {
    progress.Begin(absl::StrCat(scene.name, ": ", lights[i].name));
    const size_t view = ViewOf(i, *stages);
    const LightComparison comparison = CompareMaps((*stages)[view], lights[i], arguments.compare);
    for (WrongPixelTable* table : tables) {
      table->Add(absl::StrCat(scene.name, "/", view + 1), comparison);
    }
    progress.Advance();
  }
  return absl::OkStatus();
}

void Print(const std::string& title, const WrongPixelTable& table) {
  std::printf("\n== %s: %d lights; %d more without a matrix of every method left out\n",
              title.c_str(),
              table.num_lights(),
              table.num_left_out());
  for (const Bias bias : {Bias::kIdeal, Bias::kPractical}) {
    std::printf("%s%s", table.RatioText(bias).c_str(), table.BehindText(bias, 1.1, 5).c_str());
  }
  std::fflush(stdout);
}

absl::Status Run(const Arguments& arguments) {
  if (absl::Status status = ValidateJudgeOptions(arguments.compare.judge); !status.ok())
    return status;
  WrongPixelTable all(kMethods);
  std::vector<std::pair<std::string, WrongPixelTable>> tables;
  {
    Progress progress(arguments.scenes.num_lights * static_cast<int>(SceneCases().size()));
    absl::Status status = ForEachScene(arguments.scenes, [&](size_t scene) {
      WrongPixelTable table(kMethods);
      absl::Status added = AddScene(SceneCases()[scene], arguments, progress, {&all, &table});
      if (added.ok()) tables.emplace_back(SceneCases()[scene].name, std::move(table));
      return added;
    });
    if (!status.ok()) return status;
  }
  for (const auto& [name, table] : tables) Print(name, table);
  Print("all scenes", all);
  const std::string& path = arguments.scenes.csv_path;
  return path.empty() ? absl::OkStatus() : all.WriteCsv(path);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  // As on the command line.
  arguments.compare.fit.border = lightfit::BorderChoice::kAutomatic;
  CLI::App app("Wrong shadow pixels of every method on real scenes.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  lightfit::DeclareScenes(&app, &arguments.scenes);
  lightfit::DeclarePhases(&app, &arguments.compare.judge.phases);
  lightfit::DeclareCsv(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("scenes", lightfit::Run(arguments));
}
