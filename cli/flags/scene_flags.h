// cli/flags/scene_flags.h
//
// A scene, a camera and lights as they stand on the command line, for the verbs that render.
// In:   words; wrong syntax is refused while parsing (exit code 1).
// Out:  SceneFlags; from them the ray caster, the camera and the lights.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/flags/light_flags.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "render/generator/scene_generator.h"
#include "render/ray_caster.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// A camera in words: "EYE:TARGET[:FOV]".
struct ViewFlags {
  Eigen::Vector3d eye, target;  // world
  double fov_deg = 60.0;        // vertical
};

struct SceneFlags {
  std::string scene;                               // a path, or "generate..."
  std::optional<SceneGeneratorOptions> generator;  // present: `scene` is "generate..."
  std::string camera;                              // as given; empty: none
  std::optional<ViewFlags> view;                   // absent: `camera` is a file
  int frame = 0;                                   // of the camera file
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();   // of the view and of random lights
  LightFlags lights;
  std::vector<std::string> only;  // names; empty: all
  int num_random_lights = 0;
  uint64_t seed = 1;
};

// Declares the positional SCENE and every option on `app`, to be parsed into `flags`, which must
// stay where it is. `type_name` says in the help what the positional may be.
void DeclareSceneFlags(CLI::App* app, SceneFlags* flags, const std::string& type_name = "SCENE");

struct LoadedScene {
  RayCaster caster;
  std::string title;        // "sponza_atrium.glb", "generate:seed=1,..."
  int64_t num_dropped = 0;  // triangles without area or with bad coordinates

  int64_t num_triangles() const { return caster.scene().triangles.size(); }
};

absl::StatusOr<LoadedScene> LoadScene(const SceneFlags& flags);

// The file of the camera: --camera, or the scene itself when none is given and it is a glTF file
// with cameras. Empty: there is none.
std::string CameraPath(const SceneFlags& flags);

// Whether the lights are those of the scene: none is given, and it is a glTF file with lights.
bool TakesLightsOfScene(const SceneFlags& flags);

// The camera for an image of that size. A camera file of another size is scaled; another aspect
// ratio is an error.
absl::StatusOr<Camera> MakeViewCamera(const SceneFlags& flags, int width, int height);

// The lights of --lights, --light and --random-lights, in this order; none is an error. Light i has
// shadow bit i modulo kMaxLights: more of them than that do not fit into one read-back.
absl::StatusOr<std::vector<Light>> SceneLights(const SceneFlags& flags);

// "generate:seed=2,objects=10,triangles=50000,floor=20" or "generate:kind=room,seed=5", in any
// order.
absl::StatusOr<SceneGeneratorOptions> ParseGenerator(const std::string& text);

// "180x180"; both at least 1, together at most 2^25 pixels.
struct PixelSize {
  int width = 0, height = 0;
};
absl::StatusOr<PixelSize> ParsePixelSize(const std::string& text);

// "x,y,z:x,y,z" or "x,y,z:x,y,z:fov_deg".
absl::StatusOr<ViewFlags> ParseView(const std::string& text);

}  // namespace lightfit::cli
