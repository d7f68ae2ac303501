// io/camera_exr_input.h
//
// The camera of an EXR file that is open already; internal to io/.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "io/camera_exr.h"
#include "io/exr_input.h"

namespace lightfit::internal {

// From the attributes of `part`, or of the first part that has both. The size is that of `part`.
absl::StatusOr<Camera> CameraFromExr(const ExrInput& exr,
                                     int part,
                                     const CameraExrOptions& options);

}  // namespace lightfit::internal
