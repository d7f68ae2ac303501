// io/camera_exr_input.h
//
// The camera of an EXR file that is open already; internal to io/.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "io/camera_exr.h"
#include "io/exr_input.h"

namespace lightfit::internal {

// Where WriteReadbackExr() puts a matrix in double precision. It counts as long as it rounds to the
// standard attribute beside it: a program that changes that one need not know of this.
std::string ExactName(const std::string& attribute);

// From the attributes of `part`, or of the first part that has both. The size is that of `part`.
absl::StatusOr<Camera> CameraFromExr(const ExrInput& exr,
                                     int part,
                                     const CameraExrOptions& options);

}  // namespace lightfit::internal
