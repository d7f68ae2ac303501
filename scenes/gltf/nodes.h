// scenes/gltf/nodes.h
//
// The nodes of a glTF file and where they stand.
// In:   a Document.
// Out:  each node's matrix, CESIUM_RTC included; the nodes that the default scene shows, in the
//       order of the file.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/gltf/document.h"

namespace lightfit::gltf {

struct Nodes {
  std::vector<Eigen::Matrix4d> world_from_node;  // of all nodes
  // Below the roots of the default scene (of the first where none is named, of all roots where
  // there is no scene), parents first, without what KHR_node_visibility hides.
  std::vector<int64_t> shown;
};

// InvalidArgument for a node that has two parents or is its own ancestor, and for a matrix that is
// none.
absl::StatusOr<Nodes> ReadNodes(const Document& document);

// Translation, rotation (x, y, z, w; of any length) and scale.
Eigen::Matrix4d MatrixOf(const Eigen::Vector3d& translation,
                         const Eigen::Vector4d& rotation,
                         const Eigen::Vector3d& scale);

}  // namespace lightfit::gltf
