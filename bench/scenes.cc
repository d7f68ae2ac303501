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
#include "bench/scene_set.h"
#include "bench/wrong_pixel_table.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"

namespace lightfit {
namespace {

struct Arguments {
  int num_lights = 100;
  uint64_t seed = 1;
  std::string folder = DefaultSceneFolder();
  std::string only;
  std::string csv_path;
  CompareOptions compare;
};

// Those that have a matrix for lamps too.
const std::vector<std::string> kMethods = {
    kLightfitName, kLineName, kAsPublishedName, "focused", "lispsm", "lispsm-simple", "standard"};

absl::Status AddScene(const SceneCase& scene,
                      const Arguments& arguments,
                      Progress& progress,
                      const std::vector<WrongPixelTable*>& tables) {
  const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.folder);
  if (!caster.ok()) return caster.status();
  constexpr int kReadback = 180;
  const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
  if (!stages.ok()) return stages.status();
  const std::vector<Light> lights =
      DrawLights(scene, *caster, arguments.num_lights, arguments.seed);
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
    Progress progress(arguments.num_lights * static_cast<int>(SceneCases().size()));
    for (const SceneCase& scene : SceneCases()) {
      if (!arguments.only.empty() && scene.name != arguments.only) continue;
      WrongPixelTable table(kMethods);
      absl::Status status = AddScene(scene, arguments, progress, {&all, &table});
      if (absl::IsNotFound(status)) {
        std::printf("%s left out: %s\n", scene.name.c_str(), std::string(status.message()).c_str());
        continue;
      }
      if (!status.ok()) return status;
      tables.emplace_back(scene.name, std::move(table));
    }
  }
  for (const auto& [name, table] : tables) Print(name, table);
  Print("all scenes", all);
  return arguments.csv_path.empty() ? absl::OkStatus() : all.WriteCsv(arguments.csv_path);
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  // As on the command line.
  arguments.compare.fit.border = lightfit::BorderChoice::kAutomatic;
  CLI::App app("Wrong shadow pixels of every method on real scenes.");
  app.add_option("--lights", arguments.num_lights, "Per scene")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the lights")->capture_default_str();
  app.add_option("--scenes", arguments.folder, "Folder with the scene files")
      ->capture_default_str();
  app.add_option("--only", arguments.only, "One scene, by name");
  app.add_option("--phases",
                 arguments.compare.judge.phases,
                 "That wrong pixels are means over, JudgeOptions::phases")
      ->capture_default_str();
  app.add_option("--csv", arguments.csv_path, "One row per light");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(arguments);
  if (status.ok()) return 0;
  std::fprintf(stderr, "scenes: %s\n", std::string(status.message()).c_str());
  return 1;
}
