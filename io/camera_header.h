// io/camera_header.h
//
// The header of an EXR file that we write: the camera in worldToCamera and worldToNDC.
// In:   Camera.
// Out:  Imf::Header of its size, without channels. For the writers of this folder alone.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include "absl/status/status.h"
#include "geometry/camera.h"

namespace lightfit::internal {

// InvalidArgument for skewed pixels, which worldToNDC cannot express.
absl::Status CheckCameraAttributes(const Camera& camera);

// For a camera that was found good.
Imf::Header CameraHeader(const Camera& camera);

}  // namespace lightfit::internal
