// cli/flags/scene_flags.h
//
// A scene, a camera and lights as they stand on the command line, for the verbs that render.
// In:   words; wrong syntax is refused while parsing (exit code 1).
// Out:  SceneFlags; scene_inputs.h makes the scene, the camera and the lights of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/frame_number.h"
#include "cli/flags/light_flags.h"
#include "render/generator/scene_generator.h"

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
  std::optional<FrameNumber> frame;                // of the camera file; absent: the first
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();   // of the view and of random lights
  LightFlags lights;
  std::vector<std::string> only;  // names; empty: all
  int num_random_lights = 0;
  uint64_t seed = 1;
};

// Declares the positional SCENE and every option on `app`, to be parsed into `flags`, which must
// stay where it is. `type_name` says in the help what the positional may be.
void DeclareSceneFlags(CLI::App* app, SceneFlags* flags, const std::string& type_name = "SCENE");

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
