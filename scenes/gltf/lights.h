// scenes/gltf/lights.h
//
// The lights and cameras of a glTF file.
// In:   a Document and its Nodes.
// Out:  a Light for each node that the default scene shows with one (KHR_lights_punctual); the
//       cameras of all nodes.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "scenes/gltf/document.h"
#include "scenes/gltf/nodes.h"

namespace lightfit::gltf {

// Points and spots are point lights; a directional light is a sun that shines along its node's -z.
// Names are the nodes', or else the lights', or "light3" for node 3; a taken one gains "_2" and so
// on.
absl::StatusOr<std::vector<Light>> ReadLights(const Document& document, const Nodes& nodes);

struct CameraNode {
  std::string name;                   // the node's, or else the camera's, or "camera3" for node 3
  Eigen::Matrix4d world_from_camera;  // looks along -z, y up
  bool is_perspective = true;
  double vertical_fov_rad = 1.0;
  std::optional<double> aspect;  // width by height; absent: any
  double near = 0.0;
  std::optional<double> far;  // absent: infinite
};

absl::StatusOr<std::vector<CameraNode>> ReadCameras(const Document& document, const Nodes& nodes);

}  // namespace lightfit::gltf
