#include "bench/scene_run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

absl::Status CheckName(const std::string& only) {
  std::string names;
  for (const SceneCase& scene : SceneCases()) {
    if (only.empty() || scene.name == only) return absl::OkStatus();
    absl::StrAppend(&names, " ", scene.name);
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("--only %s: no such scene; there are%s", only, names));
}

}  // namespace

void DeclareScenes(CLI::App* app, SceneArguments* arguments) {
  app->add_option("--only", arguments->only, "One scene, by name");
  app->add_option("--scenes", arguments->folder, "Folder with the scene files")
      ->capture_default_str();
}

void DeclareHalf(CLI::App* app, SceneArguments* arguments) {
  app->add_option("--half", arguments->half, "tuning or report; default both")
      ->check(CLI::IsMember({"tuning", "report"}));
}

void DeclareLights(CLI::App* app, const std::string& flag, SceneArguments* arguments) {
  app->add_option(flag, arguments->num_lights, "Per scene")->capture_default_str();
  app->add_option("--seed", arguments->seed, "Of the lights")->capture_default_str();
}

void DeclarePhases(CLI::App* app, int* phases) {
  app->add_option("--phases", *phases, "That wrong pixels are means over, JudgeOptions::phases")
      ->capture_default_str();
}

void DeclareCsv(CLI::App* app, SceneArguments* arguments) {
  app->add_option("--csv", arguments->csv_path, "One row per light and method");
}

absl::Status ForEachScene(const SceneArguments& arguments,
                          absl::FunctionRef<absl::Status(size_t scene)> visit) {
  if (absl::Status status = CheckName(arguments.only); !status.ok()) return status;
  for (size_t i = 0; i < SceneCases().size(); ++i) {
    const std::string& name = SceneCases()[i].name;
    if (!arguments.only.empty() && name != arguments.only) continue;
    if (!arguments.half.empty() && (arguments.half == "tuning") != IsForTuning(i)) continue;
    absl::Status status = visit(i);
    if (absl::IsNotFound(status)) {
      std::printf("%s left out: %s\n", name.c_str(), std::string(status.message()).c_str());
    } else if (!status.ok()) {
      return status;
    }
  }
  return absl::OkStatus();
}

int ExitCodeOf(const char* program, const absl::Status& status) {
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s: %s\n", program, std::string(status.message()).c_str());
  return 1;
}

}  // namespace lightfit
