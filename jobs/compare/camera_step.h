// jobs/compare/camera_step.h
//
// How a camera moves from one frame to the next, in its own directions.
// In:   words "FORWARD,RIGHT,UP[,YAW_DEG[,PITCH_DEG]]", a Camera.
// Out:  CameraStep; the camera of the next frame.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "render/surface_image.h"

namespace lightfit {

// First the way, then the turns: yaw to the right, then pitch up.
struct CameraStep {
  double forward = 0.0, right = 0.0, up = 0.0;  // world units, as seen on the camera's image
  double yaw_deg = 0.0, pitch_deg = 0.0;
};

// "0.1,0,0" or "0.1,0,0,0.5" or "0.1,0,0,0.5,-1".
absl::StatusOr<CameraStep> ParseCameraStep(const std::string& text);

// "0.1 forward, 0.5 deg to the right"; "none" for no step at all.
std::string CameraStepText(const CameraStep& step);

// A step as of a walk, at the scale of what is seen: forward by 1 % of the median camera z of the
// image's surfaces, and half a degree of yaw. An image without surfaces gives the yaw alone.
CameraStep DefaultCameraStep(const SurfaceImage& image);

// The same camera, further on; what it makes of pixels stays.
Camera Stepped(const Camera& camera, const CameraStep& step);

}  // namespace lightfit
