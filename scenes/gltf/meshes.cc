#include "scenes/gltf/meshes.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "scenes/gltf/accessor.h"
#include "scenes/gltf/primitive.h"

namespace lightfit::gltf {

namespace {

// One for each joint of a skin: world from the mesh's space.
absl::StatusOr<std::vector<Eigen::Matrix4d>> JointMatrices(Document* document,
                                                           const Nodes& nodes,
                                                           int64_t skin_index) {
  const absl::StatusOr<const Json*> skin = document->Element("skins", skin_index);
  if (!skin.ok()) return skin.status();
  const std::string where = absl::StrFormat("skins[%d]", skin_index);
  const int64_t count = LengthOf(**skin, "joints");
  if (count == 0) return absl::InvalidArgumentError(absl::StrCat(where, " has no joints"));
  Numbers inverse_binds;
  if (Member(**skin, "inverseBindMatrices") != nullptr) {
    const absl::StatusOr<int64_t> index = IntegerIn(**skin, "inverseBindMatrices", where);
    if (!index.ok()) return index.status();
    absl::StatusOr<Numbers> numbers = ReadAccessor(document, *index, 16);
    if (!numbers.ok()) return numbers.status();
    if (numbers->count < count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: %d inverseBindMatrices of %d joints", where, numbers->count, count));
    }
    inverse_binds = *std::move(numbers);
  }
  if (absl::Status status = document->Take(16 * count, 0); !status.ok()) return status;
  std::vector<Eigen::Matrix4d> matrices;
  for (int64_t i = 0; i < count; ++i) {
    const Json& joint = (*Member(**skin, "joints"))[static_cast<size_t>(i)];
    const int64_t node = joint.is_number_integer() ? joint.get<int64_t>() : -1;
    if (node < 0 || node >= static_cast<int64_t>(nodes.world_from_node.size())) {
      return absl::InvalidArgumentError(absl::StrCat(where, ": joint ", i, " is no node"));
    }
    matrices.push_back(nodes.world_from_node[node]);
    if (inverse_binds.count > 0) {
      matrices.back() *= Eigen::Map<const Eigen::Matrix4d>(&inverse_binds.values[16 * i]);
    }
  }
  return matrices;
}

// Of EXT_mesh_gpu_instancing: node from instance. One that does nothing without the extension.
absl::StatusOr<std::vector<Eigen::Matrix4d>> Instances(Document* document,
                                                       const Json& node,
                                                       const std::string& where) {
  const Json* extension = Extension(node, "EXT_mesh_gpu_instancing");
  const Json* attributes = extension == nullptr ? nullptr : Member(*extension, "attributes");
  std::vector<Eigen::Matrix4d> instances = {Eigen::Matrix4d::Identity()};
  if (attributes == nullptr) return instances;
  Numbers translations, rotations, scales;
  int64_t count = -1;
  for (const auto& [name, components, numbers] : {std::tuple{"TRANSLATION", 3, &translations},
                                                  std::tuple{"ROTATION", 4, &rotations},
                                                  std::tuple{"SCALE", 3, &scales}}) {
    if (Member(*attributes, name) == nullptr) continue;
    const absl::StatusOr<int64_t> index = IntegerIn(*attributes, name, where);
    if (!index.ok()) return index.status();
    absl::StatusOr<Numbers> found = ReadAccessor(document, *index, components);
    if (!found.ok()) return found.status();
    if (count >= 0 && found->count != count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: EXT_mesh_gpu_instancing has %d %s of %d instances",
                          where,
                          found->count,
                          name,
                          count));
    }
    count = found->count;
    *numbers = *std::move(found);
  }
  if (count < 0) {
    // Attributes of other names alone still say how many.
    for (const auto& [name, value] : attributes->items()) {
      const absl::StatusOr<int64_t> index = IntegerIn(*attributes, name.c_str(), where);
      if (!index.ok()) return index.status();
      const absl::StatusOr<int64_t> stated = CountOf(*document, *index);
      if (!stated.ok()) return stated.status();
      instances.resize(*stated > 0 ? 1 : 0);  // all in one place
    }
    return instances;
  }
  instances.clear();
  for (int64_t i = 0; i < count; ++i) {
    const Eigen::Vector4d rotation =
        rotations.count == 0
            ? Eigen::Vector4d(Eigen::Vector4d::UnitW())
            : Eigen::Vector4d(
                  rotations.At(i, 0), rotations.At(i, 1), rotations.At(i, 2), rotations.At(i, 3));
    instances.push_back(MatrixOf(
        translations.count == 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                : translations.VectorAt(i),
        rotation,
        scales.count == 0 ? Eigen::Vector3d(Eigen::Vector3d::Ones()) : scales.VectorAt(i)));
  }
  return instances;
}

class MeshReader {
 public:
  MeshReader(Document* document, const Nodes& nodes) : document_(document), nodes_(nodes) {}

  absl::Status Add(int64_t node_index) {
    const Json& node = (*Member(document_->json(), "nodes"))[static_cast<size_t>(node_index)];
    if (Member(node, "mesh") == nullptr) return absl::OkStatus();
    const std::string where = absl::StrFormat("nodes[%d]", node_index);
    const absl::StatusOr<int64_t> mesh_index = IntegerIn(node, "mesh", where);
    if (!mesh_index.ok()) return mesh_index.status();
    const absl::StatusOr<const Json*> mesh = document_->Element("meshes", *mesh_index);
    if (!mesh.ok()) return mesh.status();
    const absl::StatusOr<std::vector<double>> weights = Weights(node, **mesh, where);
    if (!weights.ok()) return weights.status();
    absl::Status taken = document_->Take(static_cast<int64_t>(weights->size()), 0);
    if (!taken.ok()) return taken;
    std::vector<Eigen::Matrix4d> joints;
    if (Member(node, "skin") != nullptr) {
      const absl::StatusOr<int64_t> skin = IntegerIn(node, "skin", where);
      if (!skin.ok()) return skin.status();
      absl::StatusOr<std::vector<Eigen::Matrix4d>> matrices =
          JointMatrices(document_, nodes_, *skin);
      if (!matrices.ok()) return matrices.status();
      joints = *std::move(matrices);
    }
    absl::StatusOr<std::vector<Eigen::Matrix4d>> instances = Instances(document_, node, where);
    if (!instances.ok()) return instances.status();
    for (Eigen::Matrix4d& instance : *instances) {
      instance = nodes_.world_from_node[node_index] * instance;
    }
    for (int64_t i = 0; i < LengthOf(**mesh, "primitives"); ++i) {
      const Json& json = (*Member(**mesh, "primitives"))[static_cast<size_t>(i)];
      // Points and lines count too, so that there cannot be any number of them.
      if (absl::Status status = document_->Take(0, 1); !status.ok()) return status;
      PrimitiveReader reader(
          document_, json, absl::StrFormat("meshes[%d].primitives[%d]", *mesh_index, i));
      const absl::StatusOr<bool> has_triangles = reader.HasTriangles();
      if (!has_triangles.ok()) return has_triangles.status();
      if (!*has_triangles) continue;
      const absl::StatusOr<const Primitive*> primitive =
          Read({*mesh_index, i}, *weights, joints, &reader);
      if (!primitive.ok()) return primitive.status();
      absl::Status status = joints.empty() || !IsSkinned(json)
                                ? Append(**primitive, *instances)
                                : Append(**primitive, {Eigen::Matrix4d::Identity()});
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  Shown Finish() { return std::move(shown_); }

 private:
  static bool IsSkinned(const Json& primitive) {
    const Json* attributes = Member(primitive, "attributes");
    return attributes != nullptr && Member(*attributes, "JOINTS_0") != nullptr;
  }

  // The node's, or else the mesh's.
  static absl::StatusOr<std::vector<double>> Weights(const Json& node,
                                                     const Json& mesh,
                                                     const std::string& where) {
    const Json& owner = Member(node, "weights") != nullptr ? node : mesh;
    std::vector<double> weights(LengthOf(owner, "weights"));
    const absl::StatusOr<bool> found = NumbersIn(owner, "weights", where, absl::MakeSpan(weights));
    if (!found.ok()) return found.status();
    return weights;
  }

  // A primitive that nothing moves is kept, as other nodes may show it too.
  absl::StatusOr<const Primitive*> Read(const std::pair<int64_t, int64_t>& key,
                                        const std::vector<double>& weights,
                                        const std::vector<Eigen::Matrix4d>& joints,
                                        PrimitiveReader* reader) {
    const bool moves =
        std::any_of(weights.begin(), weights.end(), [](double weight) { return weight != 0.0; });
    const bool is_plain = joints.empty() && !moves;
    if (const auto found = plain_.find(key); is_plain && found != plain_.end()) {
      return &found->second;
    }
    absl::StatusOr<Primitive> primitive = reader->Read(weights, joints);
    if (!primitive.ok()) return primitive.status();
    Primitive& kept = is_plain ? plain_[key] : moved_;
    kept = *std::move(primitive);
    return &kept;
  }

  absl::Status Append(const Primitive& primitive, const std::vector<Eigen::Matrix4d>& places) {
    const auto num_vertices = static_cast<int64_t>(primitive.vertices.size());
    const auto num_triangles = static_cast<int64_t>(primitive.triangles.size());
    for (const Eigen::Matrix4d& world_from_mesh : places) {
      absl::Status status = document_->Take(0, num_vertices + num_triangles + 1);
      if (!status.ok()) return status;
      const auto first = static_cast<int>(shown_.vertices.size());
      for (const Eigen::Vector3d& vertex : primitive.vertices) {
        shown_.vertices.emplace_back((world_from_mesh * vertex.homogeneous()).head<3>());
      }
      for (const Eigen::Vector3i& triangle : primitive.triangles) {
        shown_.triangles.emplace_back(triangle.array() + first);
      }
      shown_.num_bad_triangles += primitive.num_bad_triangles;
    }
    return absl::OkStatus();
  }

  Document* document_;
  const Nodes& nodes_;
  std::map<std::pair<int64_t, int64_t>, Primitive> plain_;
  Primitive moved_;
  Shown shown_;
};

}  // namespace

absl::StatusOr<Shown> ReadMeshes(Document* document, const Nodes& nodes) {
  MeshReader reader(document, nodes);
  for (const int64_t node : nodes.shown) {
    if (absl::Status status = reader.Add(node); !status.ok()) return status;
  }
  return reader.Finish();
}

}  // namespace lightfit::gltf
