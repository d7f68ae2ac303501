// geometry/sized_camera.h
//
// Cameras for an image of a given size: of those that state a lens but no size, as scene files have
// them, and the same view in an image of another size.
// In:   a Camera, with a size or without; width and height in pixels.
// Out:  the Camera of an image of that size.
//
// A camera without a size has width and height 0 and a frame from (-1/2, -1/2) to (1/2, 1/2)
// instead of pixels; screen_from_camera(0, 0) is 0 when the frame may have any ratio of width to
// height. ValidateCamera() refuses it.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/camera.h"

namespace lightfit {

inline bool HasSize(const Camera& camera) { return camera.width != 0 || camera.height != 0; }

// A camera with a size stays as it is. InvalidArgument when the frame's ratio is stated and
// another: the message says how high the image would have to be.
absl::StatusOr<Camera> SizedCamera(const Camera& camera, int width, int height);

// Width by height of the frame of a camera without a size; 0 when any.
double FrameRatio(const Camera& camera);

// Of one with a size, whose image spans the same field of view. Pixels become other than square
// where the ratio of the sizes does.
Camera ResizedCamera(const Camera& camera, int width, int height);

}  // namespace lightfit
