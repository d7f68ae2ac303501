// io/camera_file.h
//
// Cameras from JSON files.
// In:   a lightfit.v1.Camera in protobuf JSON, or a scene file with "frames" (below). Unknown
// fields
//       are ignored.
// Out:  Camera, and the depth kind if the file states one.
//
// A scene file has "width", "height" and frames[i] with "camera_to_world" and "projection": 4x4,
// rows of 4 or 16 numbers row-major, column vectors, as Blender and OpenGL have them (the camera
// looks along -z, clip depth is -1 ... 1, clip y is +1 at the top of the image).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/optional.h"
#include "geometry/camera.h"
#include "lightfit/v1/camera.pb.h"

namespace lightfit {

struct CameraFile {
  Camera camera;
  absl::optional<DepthKind> depth_kind;
};

// `frame` counts from 0 and chooses from a scene file; other files hold one camera, frame 0.
absl::StatusOr<CameraFile> ReadCameraFile(const std::string& path, int frame = 0);
absl::StatusOr<CameraFile> ParseCameraJson(absl::string_view json, int frame = 0);

absl::StatusOr<CameraFile> CameraFromProto(const v1::Camera& proto);

// Writes the pose and the intrinsics; reading them back gives the same camera.
v1::Camera CameraToProto(const Camera& camera, absl::optional<DepthKind> depth_kind = {});

// Unspecified becomes absent; a number that this version does not know is an error.
absl::StatusOr<absl::optional<DepthKind>> DepthKindFromProto(v1::DepthKind kind);
v1::DepthKind DepthKindToProto(DepthKind kind);

}  // namespace lightfit
