#include "bench/scene_set.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "absl/strings/str_format.h"
#include "render/clearance.h"
#include "render/generator/dice.h"
#include "scenes/scene_file.h"

namespace lightfit {

namespace {

constexpr int kGeneratedTriangles = 200'000;

Eigen::AlignedBox3d Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return {low, high};
}

SceneCase Generated(const char* name, uint64_t seed) {
  SceneGeneratorOptions options;
  options.seed = seed;
  options.num_triangles = kGeneratedTriangles;
  return {name,
          "",
          options,
          {{{0.0, 1.7, 18.0}, {0.0, 0.5, 0.0}, 60.0},
           {{-14.0, 3.0, 12.0}, {0.0, 0.5, 0.0}, 60.0},
           {{12.0, 6.0, -14.0}, {0.0, 0.0, 0.0}, 50.0}},
          5.0,
          85.0,
          0.0,
          360.0,
          Box({-10.0, 4.0, -10.0}, {10.0, 10.0, 10.0})};
}

// Suns come in by the windows towards -x.
SceneCase GeneratedRoom(const char* name, uint64_t seed) {
  SceneGeneratorOptions options;
  options.kind = SceneKind::kRoom;
  options.seed = seed;
  options.num_triangles = kGeneratedTriangles;
  return {name,
          "",
          options,
          {{{2.3, 1.6, 3.3}, {-1.2, 0.7, -1.5}, 65.0},
           {{-2.2, 1.6, 3.3}, {1.2, 0.8, -2.0}, 65.0},
           {{2.3, 1.6, -3.3}, {-1.0, 0.6, 1.5}, 70.0}},
          15.0,
          50.0,
          130.0,
          230.0,
          Box({-2.0, 2.0, -3.0}, {2.0, 2.55, 3.0})};
}

std::vector<SceneCase> MakeSceneCases() {
  return {{"sponza_atrium",
           "sponza_atrium.glb",
           {},
           {{{-11.5, 1.7, 0.3}, {6.0, 4.5, -0.3}, 60.0},
            {{9.5, 6.6, 3.9}, {-6.0, 4.0, -2.5}, 65.0},
            {{3.5, 1.7, -4.2}, {-9.0, 2.2, -4.4}, 55.0}},
           30.0,
           85.0,
           0.0,
           360.0,
           Box({-9.0, 3.0, -1.2}, {8.0, 8.5, 1.2})},
          {"denhaag_city",
           "denhaag_city.glb",
           {},
           {{{-90.8, 8.0, 127.9}, {-103.0, 8.7, 100.4}, 65.0},
            {{106.5, 5.5, 141.1}, {81.5, 5.3, 124.5}, 65.0},
            {{-200.0, 90.0, 250.0}, {120.0, 0.0, -120.0}, 50.0}},
           8.0,
           75.0,
           0.0,
           360.0,
           Box({-120.0, 24.0, 100.0}, {120.0, 38.0, 160.0})},
          {"forest_valley",
           "forest_valley.glb",
           {},
           {{{-18.7, 1.8, -89.0}, {-21.0, 3.0, -59.0}, 65.0},
            {{-22.5, 1.8, -33.0}, {-33.3, 3.4, -61.0}, 65.0},
            {{60.0, 25.0, 120.0}, {0.0, 4.0, 0.0}, 50.0}},
           8.0,
           75.0,
           0.0,
           360.0,
           Box({-60.0, 8.0, -90.0}, {60.0, 25.0, 60.0})},
          {"objects_floor",
           "objects_floor.glb",
           {},
           {{{3.0, 1.8, -3.2}, {-0.4, 0.4, 0.2}, 55.0},
            {{-3.6, 0.7, 0.4}, {1.0, 0.6, 0.0}, 60.0},
            {{0.2, 5.5, 0.4}, {0.0, 0.0, 0.0}, 50.0}},
           20.0,
           85.0,
           0.0,
           360.0,
           Box({-4.0, 2.0, -4.0}, {4.0, 5.0, 4.0})},
          {"hotel_room",
           "hotel_room.glb",
           {},
           {{{-2.5, 1.6, -3.0}, {2.0, 0.8, 2.0}, 65.0},
            {{-1.7, 1.5, 1.3}, {-0.4, 1.2, -2.4}, 70.0},
            {{-1.5, 1.5, -4.1}, {-1.7, 1.2, 0.0}, 70.0}},
           5.0,
           40.0,
           225.0,
           315.0,
           Box({-2.6, 1.7, -4.2}, {-0.5, 2.05, 1.5})},
          {"shadow_columns",
           "shadow_columns.glb",
           {},
           {{{-228.0, 3.0, 6.0}, {0.0, 2.0, 0.0}, 55.0},
            {{-60.0, 8.0, 18.0}, {60.0, 1.0, -4.0}, 60.0},
            {{10.0, 2.0, -8.0}, {60.0, 3.0, 6.0}, 65.0}},
           8.0,
           80.0,
           0.0,
           360.0,
           Box({-220.0, 8.0, -20.0}, {220.0, 25.0, 20.0})},
          Generated("generated_2", 2),
          Generated("generated_3", 3),
          GeneratedRoom("generated_room_5", 5),
          GeneratedRoom("generated_room_6", 6)};
}

}  // namespace

const std::vector<SceneCase>& SceneCases() {
  static const auto& cases = *new std::vector<SceneCase>(MakeSceneCases());
  return cases;
}

std::string DefaultSceneFolder() {
  const char* folder = std::getenv("LIGHTFIT_SCENES");  // NOLINT(concurrency-mt-unsafe)
  if (folder != nullptr) return folder;
  return (std::filesystem::path(LIGHTFIT_REPOSITORY).parent_path() / "shared" / "scenes").string();
}

absl::StatusOr<RayCaster> LoadSceneCase(const SceneCase& scene, const std::string& folder) {
  if (scene.file.empty()) {
    absl::StatusOr<Scene> generated = GenerateScene(scene.generated);
    if (!generated.ok()) return generated.status();
    return RayCaster::Build(*std::move(generated));
  }
  absl::StatusOr<SceneFile> file = ReadScene((std::filesystem::path(folder) / scene.file).string());
  if (!file.ok()) return file.status();
  return RayCaster::Build(std::move(file->scene));
}

absl::StatusOr<std::vector<CompareStage>> MakeStages(const SceneCase& scene,
                                                     const RayCaster& caster,
                                                     int readback_size) {
  std::vector<CompareStage> stages;
  for (const SceneView& view : scene.views) {
    const absl::StatusOr<Camera> camera = LookAtCamera(view.position,
                                                       view.target,
                                                       Eigen::Vector3d::UnitY(),
                                                       view.fov_deg * M_PI / 180.0,
                                                       kScreenSize,
                                                       kScreenSize);
    if (!camera.ok()) return camera.status();
    absl::StatusOr<CompareStage> stage = MakeStage(caster, *camera, readback_size, readback_size);
    if (!stage.ok()) return stage.status();
    stages.push_back(*std::move(stage));
  }
  return stages;
}

std::vector<Light> DrawLights(const SceneCase& scene,
                              const RayCaster& caster,
                              int count,
                              uint64_t seed) {
  const double least_clearance = 2e-3 * caster.bounds().diagonal().norm();
  constexpr int kAttempts = 100;
  constexpr double kRadPerDeg = M_PI / 180.0;
  std::vector<Light> lights;
  for (int i = 0; i < count; ++i) {
    Dice dice(1000 * seed + i);
    if (i % 3 == 2 && !scene.lamps.isEmpty()) {
      Eigen::Vector3d position;
      for (int attempt = 0; attempt < kAttempts; ++attempt) {
        for (int axis = 0; axis < 3; ++axis) {
          position(axis) = dice.Uniform(scene.lamps.min()(axis), scene.lamps.max()(axis));
        }
        if (Clearance(caster, position) > least_clearance) break;
      }
      lights.push_back(Light::Point(absl::StrFormat("lamp%03d", i + 1), position));
      continue;
    }
    const double elevation =
        dice.Uniform(scene.min_elevation_deg, scene.max_elevation_deg) * kRadPerDeg;
    const double azimuth = dice.Uniform(scene.min_azimuth_deg, scene.max_azimuth_deg) * kRadPerDeg;
    const Eigen::Vector3d to_sun(std::cos(elevation) * std::cos(azimuth),
                                 std::sin(elevation),
                                 std::cos(elevation) * std::sin(azimuth));
    lights.push_back(Light::Directional(absl::StrFormat("sun%03d", i + 1), -to_sun));
  }
  return lights;
}

}  // namespace lightfit
