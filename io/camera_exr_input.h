// io/camera_exr_input.h
//
// The camera of an EXR file that is open already; internal to io/.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/camera.h"
#include "io/camera_exr.h"
#include "io/exr_input.h"

namespace lightfit::internal {

// Where WriteReadbackExr() puts a matrix in double precision. It counts as long as it rounds to the
// standard attribute beside it: a program that changes that one need not know of this.
std::string ExactName(const std::string& attribute);

struct CameraOfPart {
  Camera camera;
  int part = 0;           // whose attributes these are
  bool is_exact = false;  // WriteReadbackExr() wrote them
};

// From the attributes of `part`, or of the other parts that have both and are of the same `view`
// (empty: of any); the size is that of `part`. InvalidArgument where these others differ, and where
// a part of several views has the camera of another one, which is that of its default view.
absl::StatusOr<CameraOfPart> CameraFromExr(const ExrInput& exr,
                                           int part,
                                           absl::string_view view,
                                           const CameraExrOptions& options);

}  // namespace lightfit::internal
