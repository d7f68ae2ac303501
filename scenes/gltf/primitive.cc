#include "scenes/gltf/primitive.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit::gltf {

namespace {

enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };

// Corners of triangle i in the list of indices.
Eigen::Matrix<int64_t, 3, 1> CornersOf(int64_t mode, int64_t i) {
  if (mode == kStrip) return {i, i + 1 + i % 2, i + 2 - i % 2};
  if (mode == kFan) return {0, i + 1, i + 2};
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

// Vertices that no triangle has are left out: many primitives may share one list of positions.
void DropUnused(Primitive* primitive) {
  if (4 * primitive->triangles.size() >= primitive->vertices.size()) return;
  std::vector<int> used;
  for (const Eigen::Vector3i& triangle : primitive->triangles) {
    used.insert(used.end(), triangle.begin(), triangle.end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(used.size());
  for (const int vertex : used) vertices.push_back(primitive->vertices[vertex]);
  for (Eigen::Vector3i& triangle : primitive->triangles) {
    for (int& corner : triangle) {
      corner = static_cast<int>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
    }
  }
  primitive->vertices = std::move(vertices);
}

}  // namespace

PrimitiveReader::PrimitiveReader(Document* document, const Json& primitive, std::string where)
    : document_(document), json_(primitive), where_(std::move(where)) {}

absl::StatusOr<bool> PrimitiveReader::HasTriangles() const {
  const absl::StatusOr<int64_t> mode = IntegerIn(json_, "mode", where_, kTriangles);
  if (!mode.ok()) return mode.status();
  if (*mode > kFan) {
    return absl::InvalidArgumentError(absl::StrFormat("%s.mode = %d, want 0 to 6", where_, *mode));
  }
  return *mode >= kTriangles;
}

absl::Status PrimitiveReader::OpenDraco() {
  const Json* extension = Extension(json_, "KHR_draco_mesh_compression");
  if (extension == nullptr || draco_.has_value()) return absl::OkStatus();
  const std::string where = where_ + ".KHR_draco_mesh_compression";
  const absl::StatusOr<int64_t> index = IntegerIn(*extension, "bufferView", where);
  if (!index.ok()) return index.status();
  const absl::StatusOr<View> view = document_->BufferView(*index);
  if (!view.ok()) return view.status();
  absl::StatusOr<DracoMesh> mesh = DracoMesh::Decode(view->bytes);
  if (!mesh.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(where, ": ", mesh.status().message()));
  }
  draco_attributes_ = Member(*extension, "attributes");
  draco_ = *std::move(mesh);
  return absl::OkStatus();
}

absl::StatusOr<Numbers> PrimitiveReader::Attribute(const std::string& name, int components) {
  const Json* attributes = Member(json_, "attributes");
  if (draco_.has_value() && draco_attributes_ != nullptr &&
      Member(*draco_attributes_, name.c_str()) != nullptr) {
    const absl::StatusOr<int64_t> id = IntegerIn(*draco_attributes_, name.c_str(), where_);
    if (!id.ok()) return id.status();
    absl::Status status = document_->Take(draco_->num_vertices() * components, 0);
    if (!status.ok()) return status;
    return draco_->Attribute(*id, components);
  }
  if (attributes == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(where_, " has no attributes"));
  }
  const absl::StatusOr<int64_t> index = IntegerIn(*attributes, name.c_str(), where_);
  if (!index.ok()) return index.status();
  return ReadAccessor(document_, *index, components);
}

absl::StatusOr<std::vector<double>> PrimitiveReader::Indices(int64_t num_vertices) {
  if (draco_.has_value()) {
    absl::Status status = document_->Take(3 * draco_->num_triangles(), 0);
    if (!status.ok()) return status;
    return draco_->Indices();
  }
  if (Member(json_, "indices") == nullptr) {
    std::vector<double> indices(static_cast<size_t>(num_vertices));
    for (int64_t i = 0; i < num_vertices; ++i) indices[i] = static_cast<double>(i);
    return indices;
  }
  const absl::StatusOr<int64_t> index = IntegerIn(json_, "indices", where_);
  if (!index.ok()) return index.status();
  absl::StatusOr<Numbers> numbers = ReadAccessor(document_, *index, 1);
  if (!numbers.ok()) return numbers.status();
  return std::move(numbers->values);
}

absl::Status PrimitiveReader::Morph(absl::Span<const double> weights,
                                    std::vector<Eigen::Vector3d>* vertices) {
  const int64_t num_targets = LengthOf(json_, "targets");
  for (int64_t i = 0; i < std::min<int64_t>(num_targets, weights.size()); ++i) {
    const Json& target = (*Member(json_, "targets"))[static_cast<size_t>(i)];
    if (weights[i] == 0.0 || Member(target, "POSITION") == nullptr) continue;
    const absl::StatusOr<int64_t> index = IntegerIn(target, "POSITION", where_ + ".targets");
    if (!index.ok()) return index.status();
    const absl::StatusOr<Numbers> moves = ReadAccessor(document_, *index, 3);
    if (!moves.ok()) return moves.status();
    if (moves->count != static_cast<int64_t>(vertices->size())) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s.targets[%d]: moves %d vertices, want %d", where_, i, moves->count, vertices->size()));
    }
    for (int64_t v = 0; v < moves->count; ++v) (*vertices)[v] += weights[i] * moves->VectorAt(v);
  }
  return absl::OkStatus();
}

absl::Status PrimitiveReader::Skin(absl::Span<const Eigen::Matrix4d> joint_matrices,
                                   std::vector<Eigen::Vector3d>* vertices) {
  const auto count = static_cast<int64_t>(vertices->size());
  std::vector<Eigen::Vector4d> sums(vertices->size(), Eigen::Vector4d::Zero());
  const Json* attributes = Member(json_, "attributes");
  for (int set = 0; Member(*attributes, absl::StrCat("JOINTS_", set).c_str()) != nullptr; ++set) {
    const absl::StatusOr<Numbers> joints = Attribute(absl::StrCat("JOINTS_", set), 4);
    if (!joints.ok()) return joints.status();
    const absl::StatusOr<Numbers> weights = Attribute(absl::StrCat("WEIGHTS_", set), 4);
    if (!weights.ok()) return weights.status();
    if (joints->count != count || weights->count != count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: %d joints and %d weights of %d vertices, want as many",
                          where_,
                          joints->count,
                          weights->count,
                          count));
    }
    for (int64_t v = 0; v < count; ++v) {
      const Eigen::Vector4d vertex = (*vertices)[v].homogeneous();
      for (int k = 0; k < 4; ++k) {
        const double weight = weights->At(v, k), joint = joints->At(v, k);
        if (weight == 0.0) continue;
        if (!(joint >= 0.0 && joint < static_cast<double>(joint_matrices.size()))) {
          return absl::InvalidArgumentError(absl::StrFormat(
              "%s.JOINTS_%d: joint %g of %d", where_, set, joint, joint_matrices.size()));
        }
        // The fourth is the sum of the weights, which exporters round.
        sums[v] += weight * (joint_matrices[static_cast<size_t>(joint)] * vertex);
      }
    }
  }
  for (int64_t v = 0; v < count; ++v) {
    if (sums[v].w() > 0.0) (*vertices)[v] = sums[v].hnormalized();
  }
  return absl::OkStatus();
}

absl::StatusOr<Primitive> PrimitiveReader::Read(absl::Span<const double> weights,
                                                absl::Span<const Eigen::Matrix4d> joint_matrices) {
  if (absl::Status status = OpenDraco(); !status.ok()) return status;
  const absl::StatusOr<int64_t> mode = IntegerIn(json_, "mode", where_, kTriangles);
  if (!mode.ok()) return mode.status();
  const absl::StatusOr<Numbers> positions = Attribute("POSITION", 3);
  if (!positions.ok()) return positions.status();
  Primitive primitive;
  primitive.vertices.reserve(static_cast<size_t>(positions->count));
  for (int64_t i = 0; i < positions->count; ++i) {
    primitive.vertices.push_back(positions->VectorAt(i));
  }
  if (absl::Status status = Morph(weights, &primitive.vertices); !status.ok()) return status;
  if (!joint_matrices.empty()) {
    if (absl::Status status = Skin(joint_matrices, &primitive.vertices); !status.ok())
      return status;
  }
  const absl::StatusOr<std::vector<double>> indices = Indices(positions->count);
  if (!indices.ok()) return indices.status();
  const auto num_indices = static_cast<int64_t>(indices->size());
  const int64_t num_triangles = draco_.has_value() || *mode == kTriangles
                                    ? num_indices / 3
                                    : std::max<int64_t>(num_indices - 2, 0);
  for (int64_t i = 0; i < num_triangles; ++i) {
    const auto corners = CornersOf(draco_.has_value() ? int64_t{kTriangles} : *mode, i);
    Eigen::Vector3i triangle;
    bool good = true;
    for (int k = 0; k < 3; ++k) {
      const double index = (*indices)[corners[k]];
      good = good && index >= 0.0 && index < static_cast<double>(positions->count);
      if (good) triangle[k] = static_cast<int>(index);
    }
    if (good) {
      primitive.triangles.push_back(triangle);
    } else {
      ++primitive.num_bad_triangles;
    }
  }
  DropUnused(&primitive);
  return primitive;
}

}  // namespace lightfit::gltf
