// io/camera_file.h
//
// Cameras from JSON files.
// In:   a lightfit.v1.Camera in protobuf JSON, or a scene file with "frames" (below). Unknown
//       fields are ignored.
//       Or a .glb or .gltf file, "scene.glb:NAME" (scenes/gltf_view.h): its camera has no size yet
//       (geometry/sized_camera.h).
// Out:  Camera, and the depth kind if the file states one.
//
// A scene file has "width", "height" and frames[i] with "camera_to_world" and "projection": 4x4,
// rows of 4 or 16 numbers row-major, column vectors, as Blender and OpenGL have them (the camera
// looks along -z, clip depth is -1 ... 1, clip y is +1 at the top of the image).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "wire/camera_proto.h"

namespace lightfit {

// `frame` counts from 0 and chooses from a scene file; other files hold one camera, frame 0.
absl::StatusOr<StatedCamera> ReadCameraFile(const std::string& path, int frame = 0);
absl::StatusOr<StatedCamera> ParseCameraJson(absl::string_view json, int frame = 0);

}  // namespace lightfit
