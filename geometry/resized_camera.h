// geometry/resized_camera.h
//
// The same view in an image of another size.
// In:   a Camera, width and height in pixels.
// Out:  the Camera whose image spans the same field of view.
#pragma once

#include "geometry/camera.h"

namespace lightfit {

// Pixels become other than square where the ratio of the sizes does.
Camera ResizedCamera(const Camera& camera, int width, int height);

}  // namespace lightfit
