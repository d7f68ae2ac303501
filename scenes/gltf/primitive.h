// scenes/gltf/primitive.h
//
// The triangles of one primitive of a mesh, and what moves its vertices.
// In:   a Document and a primitive.
// Out:  triangles, and for each vertex its place at rest, its morph targets applied, or its joints.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "scenes/gltf/accessor.h"
#include "scenes/gltf/draco.h"

namespace lightfit::gltf {

struct Primitive {
  std::vector<Eigen::Vector3d> vertices;   // in the mesh's space
  std::vector<Eigen::Vector3i> triangles;  // indices into `vertices`
  int64_t num_bad_triangles = 0;           // left out: a corner that is not there
};

class PrimitiveReader {
 public:
  // Refers to both. `where` names the primitive in messages, "meshes[1].primitives[0]".
  PrimitiveReader(Document* document, const Json& primitive, std::string where);

  // Whether there are triangles at all, not points or lines.
  absl::StatusOr<bool> HasTriangles() const;

  // Morph targets with `weights`; those beyond the end of `weights` have none. When
  // `matrices` is given, vertices are skinned: each is the mean of what the matrices of its joints
  // make of it.
  absl::StatusOr<Primitive> Read(absl::Span<const double> weights,
                                 absl::Span<const Eigen::Matrix4d> joint_matrices);

 private:
  absl::Status OpenDraco();
  absl::StatusOr<Numbers> Attribute(const std::string& name, int components);
  absl::StatusOr<std::vector<double>> Indices(int64_t num_vertices);
  absl::Status Morph(absl::Span<const double> weights, std::vector<Eigen::Vector3d>* vertices);
  absl::Status Skin(absl::Span<const Eigen::Matrix4d> joint_matrices,
                    std::vector<Eigen::Vector3d>* vertices);

  Document* document_;
  const Json& json_;
  std::string where_;
  const Json* draco_attributes_ = nullptr;
  std::optional<DracoMesh> draco_;
};

}  // namespace lightfit::gltf
