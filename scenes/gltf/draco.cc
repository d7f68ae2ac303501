#include "scenes/gltf/draco.h"

#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <utility>

#include "absl/strings/str_format.h"

namespace lightfit::gltf {

struct DracoMesh::State {
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(std::unique_ptr<State> state) : state_(std::move(state)) {}
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh& DracoMesh::operator=(DracoMesh&&) noexcept = default;
DracoMesh::~DracoMesh() = default;

absl::StatusOr<DracoMesh> DracoMesh::Decode(absl::string_view packed) {
  draco::DecoderBuffer buffer;
  buffer.Init(packed.data(), packed.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%d bytes cannot be unpacked (%s)", packed.size(), mesh.status().error_msg_string()));
  }
  auto state = std::make_unique<State>();
  state->mesh = std::move(mesh).value();
  return DracoMesh(std::move(state));
}

int64_t DracoMesh::num_vertices() const { return state_->mesh->num_points(); }
int64_t DracoMesh::num_triangles() const { return state_->mesh->num_faces(); }

std::vector<double> DracoMesh::Indices() const {
  std::vector<double> indices;
  indices.reserve(static_cast<size_t>(3 * num_triangles()));
  for (draco::FaceIndex face(0); face < state_->mesh->num_faces(); ++face) {
    for (const draco::PointIndex& point : state_->mesh->face(face)) {
      indices.push_back(point.value());
    }
  }
  return indices;
}

absl::StatusOr<Numbers> DracoMesh::Attribute(int64_t id, int components) const {
  const draco::PointAttribute* attribute =
      id > UINT32_MAX ? nullptr : state_->mesh->GetAttributeByUniqueId(static_cast<uint32_t>(id));
  if (attribute == nullptr || attribute->num_components() != components) {
    return absl::InvalidArgumentError(
        absl::StrFormat("has no attribute %d with %d numbers each", id, components));
  }
  Numbers numbers{num_vertices(), components, {}};
  numbers.values.resize(static_cast<size_t>(numbers.count * components));
  for (draco::PointIndex point(0); point < state_->mesh->num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute->mapped_index(point);
    double* out = numbers.values.data() + static_cast<int64_t>(point.value()) * components;
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue<double>(value, static_cast<int8_t>(components), out)) {
      return absl::InvalidArgumentError(absl::StrFormat("attribute %d cannot be unpacked", id));
    }
  }
  return numbers;
}

}  // namespace lightfit::gltf
