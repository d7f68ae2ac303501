// scenes/gltf_view.h
//
// The lights and cameras of a glTF file, for options that take files of lights or cameras.
// In:   the path of a .glb or .gltf file; for cameras "scene.glb:NAME" chooses one, by its name or
//       its number among them from 0.
// Out:  lights as the JSON of a lights file; a camera without a size (geometry/sized_camera.h).
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/camera.h"

namespace lightfit {

// By the end of its name; true also with a camera's name behind it.
bool IsGltf(absl::string_view path);

// {"lights": [{"name": "sun", "direction": [x, y, z]}, {"name": "lamp", "position": [x, y, z]}]} of
// the lights (KHR_lights_punctual) that the file shows. InvalidArgument, with the path, when there
// is none; NotFound without the file.
absl::StatusOr<std::string> GltfLightsJson(const std::string& path);

// InvalidArgument that lists the cameras when there are several and none is chosen, when there is
// none of that name, and when it is orthographic.
absl::StatusOr<Camera> ReadGltfCamera(const std::string& path);

// What a file has to offer; none for a file that cannot be read.
struct GltfContents {
  int num_lights = 0;
  std::vector<std::string> cameras;
};
GltfContents ContentsOf(const std::string& path);

}  // namespace lightfit
