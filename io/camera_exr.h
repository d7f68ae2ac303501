// io/camera_exr.h
//
// The camera from the attributes worldToCamera and worldToNDC of an EXR header.
// In:   the two matrices as stored, the size of the display window, the renderer's convention.
// Out:  Camera: camera_from_world from the first, the intrinsics from worldToNDC.
//
// Standard: OpenEXR, "Standard Attributes": camera space +x right, +y up, +z forward; NDC is 2D,
// (0, 0) the upper left and (1, 1) the lower right of the display window. Nothing is guessed:
// matrices that do not hold together under the stated convention are refused, and the message names
// the words of io/camera_convention.h under which they would.
//
// Any lens shift holds together under both NDC ranges. So a camera's axis that lies further than
// kLikelyFrameShift from the middle is refused where another convention puts it nearer, unless the
// convention is stated to be "shifted"; else it is read.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "io/camera_convention.h"

namespace lightfit {

// Distance of the principal point from the middle of the frame, in frame widths or heights,
// whichever is more: of most lenses. A wrong NDC range moves it by 0.25 or more.
inline constexpr double kLikelyFrameShift = 0.2;
double FrameShift(const Camera& camera);

struct CameraExrOptions {
  CameraConvention convention;

  // Clip planes, world units, which the attributes do not tell. Needed for NDC depth only.
  double near = 0.0;
  double far = std::numeric_limits<double>::infinity();

  // Width over height of a pixel; 0: the file's pixelAspectRatio, or 1 without one. >= 0.
  double pixel_aspect = 0.0;
};

// `world_to_camera` and `world_to_ndc` hold the 16 numbers as stored: (r, c) is number 4 r + c.
absl::StatusOr<Camera> CameraFromExrMatrices(const Eigen::Matrix4d& world_to_camera,
                                             const Eigen::Matrix4d& world_to_ndc,
                                             int width,
                                             int height,
                                             const CameraExrOptions& options = {});

// The camera of the first part of the file, or, where it has not both attributes, of the others,
// which must agree.
absl::StatusOr<Camera> ReadCameraExr(const std::string& path, const CameraExrOptions& options = {});

}  // namespace lightfit
