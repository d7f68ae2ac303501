// cli/flags/scene_inputs.h
//
// What the flags of a verb that renders name: a scene, a camera and lights.
// In:   SceneFlags, and the files that they name.
// Out:  the ray caster, the camera for an image of some size, the lights; or what is wrong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/flags/scene_flags.h"
#include "geometry/camera.h"
#include "geometry/light.h"
#include "render/ray_caster.h"

namespace lightfit::cli {

// What the command line lacks, all of it at once, with what else the verb misses: InvalidArgument
// with every option that is to be added.
absl::Status CheckSceneNeeds(const SceneFlags& flags, std::vector<std::string> missing = {});

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

// What an image is where no size is asked for: so many pixels high, and as wide as the file of the
// camera says for the frame; square where it says nothing, or there is none.
PixelSize DefaultImageSize(const SceneFlags& flags, int height);

// The lights of --lights, --light and --random-lights, in this order; none is an error. Light i has
// shadow bit i modulo kMaxLights: more of them than that do not fit into one read-back.
absl::StatusOr<std::vector<Light>> SceneLights(const SceneFlags& flags);

}  // namespace lightfit::cli
