// bench/scene_set.h
//
// Real scenes with cameras and lights to draw from: those of the folder ../shared/scenes beside the
// repository, whose README.md lists the same figures; and generated ones.
// In:   a folder with the files.
// Out:  scenes with their cameras and random lights, the same for the same seed.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "jobs/compare/stage.h"
#include "render/generator/scene_generator.h"
#include "render/ray_caster.h"

namespace lightfit {

struct SceneView {
  Eigen::Vector3d position, target;  // up is +y, metres
  double fov_deg = 60.0;             // vertical
};

struct SceneCase {
  std::string name;
  std::string file;  // under the folder; empty: generated
  SceneGeneratorOptions generated = {};
  std::vector<SceneView> views;
  // Suns are drawn uniformly in elevation and azimuth, degrees.
  double min_elevation_deg, max_elevation_deg, min_azimuth_deg, max_azimuth_deg;
  // Lamps are drawn uniformly from this box, if it is not empty: every third light.
  Eigen::AlignedBox3d lamps;
};

const std::vector<SceneCase>& SceneCases();

// Every second scene is there for choosing, the others for the report.
inline bool IsForTuning(size_t scene) { return scene % 2 == 1; }

// "../shared/scenes" beside the repository, or the environment's LIGHTFIT_SCENES.
std::string DefaultSceneFolder();

// NotFound when the file is absent.
absl::StatusOr<RayCaster> LoadSceneCase(const SceneCase& scene, const std::string& folder);

// One for each view, with a square screen of 750 pixels, the size of Chong & Gortler 3.
absl::StatusOr<std::vector<CompareStage>> MakeStages(const SceneCase& scene,
                                                     const RayCaster& caster,
                                                     int readback_size);
inline constexpr int kScreenSize = 750;

// The view that the i-th light is judged in: each takes its turn with suns and lamps.
inline size_t ViewOf(size_t light, const std::vector<CompareStage>& stages) {
  return light / 3 % stages.size();
}

// The same first lights whatever the count. Lamps keep their distance from surfaces.
std::vector<Light> DrawLights(const SceneCase& scene,
                              const RayCaster& caster,
                              int count,
                              uint64_t seed);

}  // namespace lightfit
