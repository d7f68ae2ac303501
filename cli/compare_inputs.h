// cli/compare_inputs.h
//
// What `lightfit compare` works on: the scene or read-back, the lights and the matrices that the
// flags name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/flags/compare_flags.h"
#include "cli/flags/fit_inputs.h"
#include "cli/flags/scene_inputs.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"

namespace lightfit::cli {

struct CompareInputs {
  // The scene, or the read-back and maybe its next frame: they outlive `stage` and `next`.
  std::unique_ptr<LoadedScene> scene;
  std::unique_ptr<FitInputs> readback, next_readback;

  CompareStage stage;
  std::string title;
  std::vector<Light> lights;
  std::vector<absl::Status> light_status;  // whether the light could be read

  std::unique_ptr<NextFrame> next;  // null: no crawl is measured
  std::string next_title;           // "the camera moves 0.1 forward", "frame 3", "0002.exr"

  CompareOptions options;
  std::vector<std::string> warnings;
};

absl::StatusOr<CompareInputs> ReadCompareInputs(const CompareFlags& flags);

}  // namespace lightfit::cli
