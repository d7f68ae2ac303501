// bench/scene_run.h
//
// What every benchmark over the scenes of bench/scene_set.h has in common.
// In:   the command line: which scenes, lights, files.
// Out:  one visit for each scene that is there; those whose file is absent are named and left out.
#pragma once

#include <cstdint>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "bench/scene_set.h"

namespace CLI {
class App;
}

namespace lightfit {

struct SceneArguments {
  int num_lights = 0;     // per scene
  uint64_t seed = 0;      // of the lights
  int phases = 4;         // that wrong pixels are means over
  std::string half = {};  // "tuning" or "report" (IsForTuning()); empty: both
  std::string only = {};  // a scene's name; empty: all
  std::string folder = DefaultSceneFolder();
  std::string csv_path = {};  // empty: none
};

// Parts of them, each with its default.
void DeclareScenes(CLI::App* app, SceneArguments* arguments);  // --only, --scenes
void DeclareHalf(CLI::App* app, SceneArguments* arguments);    // --half
void DeclareLights(CLI::App* app,
                   const std::string& flag,
                   SceneArguments* arguments);  // and --seed
void DeclarePhases(CLI::App* app, int* phases);
void DeclareCsv(CLI::App* app, SceneArguments* arguments);

// Calls visit(i) for each of SceneCases() that is asked for. NotFound from a visit leaves that
// scene out; any other error ends the run. InvalidArgument for a name that is none.
absl::Status ForEachScene(const SceneArguments& arguments,
                          absl::FunctionRef<absl::Status(size_t scene)> visit);

// What the program returns: 0, or 1 with the error on stderr.
int ExitCodeOf(const char* program, const absl::Status& status);

}  // namespace lightfit
