// scenes/gltf/meshes.h
//
// All triangles that a glTF file shows: meshes under their nodes, skinned, morphed and instanced.
// In:   a Document and its Nodes.
// Out:  triangles in world space.
//
// Animations are left out: skins are as their joints stand in the file, morph targets have the
// node's weights or else the mesh's. A skinned mesh stands where its joints are, wherever its own
// node is (glTF 2.0, 3.7.3.3).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/gltf/document.h"
#include "scenes/gltf/nodes.h"

namespace lightfit::gltf {

struct Shown {
  std::vector<Eigen::Vector3d> vertices;   // world
  std::vector<Eigen::Vector3i> triangles;  // indices into `vertices`
  int64_t num_bad_triangles = 0;           // left out: a corner that is not there
};

absl::StatusOr<Shown> ReadMeshes(Document* document, const Nodes& nodes);

}  // namespace lightfit::gltf
