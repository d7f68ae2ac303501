// scenes/gltf/draco.h
//
// Meshes under KHR_draco_mesh_compression. The one place that knows Draco.
// In:   the packed bytes of a primitive.
// Out:  triangles and attributes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "scenes/gltf/accessor.h"

namespace lightfit::gltf {

class DracoMesh {
 public:
  // InvalidArgument when the bytes cannot be unpacked.
  static absl::StatusOr<DracoMesh> Decode(absl::string_view packed);

  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) noexcept;
  ~DracoMesh();

  int64_t num_vertices() const;
  int64_t num_triangles() const;
  std::vector<double> Indices() const;  // three to a triangle

  // An attribute by the number that the extension gives it.
  absl::StatusOr<Numbers> Attribute(int64_t id, int components) const;

 private:
  struct State;
  explicit DracoMesh(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace lightfit::gltf
