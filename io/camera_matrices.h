// io/camera_matrices.h
//
// The matrices worldToCamera and worldToNDC taken apart; internal to io/.
// In:   the two matrices as stored, the size of the frame, a convention.
// Out:  the camera as that convention reads them, or why they do not hold together under it.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "io/camera_exr.h"

namespace lightfit::internal {

// The axis may meet the frame anywhere, and outside. InvalidArgument names the attribute.
absl::StatusOr<Camera> CameraUnderConvention(const Eigen::Matrix4d& world_to_camera,
                                             const Eigen::Matrix4d& world_to_ndc,
                                             int width,
                                             int height,
                                             const CameraExrOptions& options);

}  // namespace lightfit::internal
