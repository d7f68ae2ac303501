// io/camera_file.h
//
// Cameras from JSON files.
// In:   a lightfit.v1.Camera in protobuf JSON, or a scene file with "frames" (below). Unknown
//       fields are ignored.
//       Or a .glb or .gltf file, "scene.glb:NAME" (scenes/gltf_view.h): its camera has no size yet
//       (geometry/sized_camera.h).
// Out:  cameras, by frame; and the depth kind if the file states one.
//
// A scene file has "width", "height" and frames[i] with "camera_to_world" and "projection": 4x4,
// rows of 4 or 16 numbers row-major, column vectors, as Blender and OpenGL have them (the camera
// looks along -z, clip depth is -1 ... 1, clip y is +1 at the top of the image). Its frames may say
// which they are: "frame": 1001 in each, or other forms of io/frames/frame_table.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "base/frame_number.h"
#include "wire/camera_proto.h"

namespace lightfit {

struct CameraFile {
  // One or more; those of a scene file each with its own status.
  std::vector<absl::StatusOr<StatedCamera>> cameras;
  std::vector<std::optional<FrameNumber>> numbers;  // of cameras[i]: of all or of none

  // One camera that does not say which frame it is of is that of all: it stands still.
  bool IsForAll() const { return cameras.size() == 1 && !numbers[0].has_value(); }
};

absl::StatusOr<CameraFile> ReadCameras(const std::string& path);
absl::StatusOr<CameraFile> ParseCameras(absl::string_view json);

// One of them: that of a frame where the file says which they are, else the one at that place,
// counted from 0. Without `frame` the first.
absl::StatusOr<StatedCamera> ReadCameraFile(const std::string& path,
                                            const std::optional<FrameNumber>& frame = {});
absl::StatusOr<StatedCamera> ParseCameraJson(absl::string_view json,
                                             const std::optional<FrameNumber>& frame = {});

}  // namespace lightfit
