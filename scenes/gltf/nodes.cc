#include "scenes/gltf/nodes.h"

#include <Eigen/Geometry>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"

namespace lightfit::gltf {

namespace {

absl::StatusOr<Eigen::Matrix4d> LocalMatrix(const Json& node, const std::string& where) {
  Eigen::Matrix4d matrix;
  const absl::StatusOr<bool> has_matrix =
      NumbersIn(node, "matrix", where, absl::MakeSpan(matrix.data(), 16));
  if (!has_matrix.ok()) return has_matrix.status();
  if (*has_matrix) return matrix;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  Eigen::Vector4d rotation = Eigen::Vector4d::UnitW();
  for (const auto& [name, numbers] :
       {std::pair{"translation", absl::MakeSpan(translation.data(), 3)},
        std::pair{"rotation", absl::MakeSpan(rotation.data(), 4)},
        std::pair{"scale", absl::MakeSpan(scale.data(), 3)}}) {
    const absl::StatusOr<bool> found = NumbersIn(node, name, where, numbers);
    if (!found.ok()) return found.status();
  }
  return MatrixOf(translation, rotation, scale);
}

// The indices in a list of nodes.
absl::StatusOr<std::vector<int64_t>> Indices(const Document& document,
                                             const Json& object,
                                             const char* name) {
  std::vector<int64_t> indices;
  for (int64_t i = 0; i < LengthOf(object, name); ++i) {
    const Json& item = (*Member(object, name))[static_cast<size_t>(i)];
    const int64_t index = item.is_number_integer() ? item.get<int64_t>() : -1;
    const absl::StatusOr<const Json*> node = document.Element("nodes", index);
    if (!node.ok()) return node.status();
    indices.push_back(index);
  }
  return indices;
}

absl::StatusOr<std::vector<int64_t>> RootsShown(const Document& document,
                                                const std::vector<int64_t>& parents) {
  if (LengthOf(document.json(), "scenes") > 0) {
    const absl::StatusOr<int64_t> index = IntegerIn(document.json(), "scene", "the file", 0);
    if (!index.ok()) return index.status();
    const absl::StatusOr<const Json*> scene = document.Element("scenes", *index);
    if (!scene.ok()) return scene.status();
    return Indices(document, **scene, "nodes");
  }
  std::vector<int64_t> roots;
  for (size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] < 0) roots.push_back(static_cast<int64_t>(i));
  }
  return roots;
}

}  // namespace

Eigen::Matrix4d MatrixOf(const Eigen::Vector3d& translation,
                         const Eigen::Vector4d& rotation,
                         const Eigen::Vector3d& scale) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const double length = rotation.stableNorm();
  if (length > 0.0) {
    const Eigen::Vector4d unit = rotation / length;
    matrix.topLeftCorner<3, 3>() =
        Eigen::Quaterniond(unit.w(), unit.x(), unit.y(), unit.z()).toRotationMatrix();
  }
  matrix.topLeftCorner<3, 3>() *= scale.asDiagonal();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

absl::StatusOr<Nodes> ReadNodes(const Document& document) {
  const int64_t count = LengthOf(document.json(), "nodes");
  std::vector<int64_t> parents(count, -1);
  std::vector<std::vector<int64_t>> children(count);
  Nodes nodes;
  nodes.world_from_node.resize(count);
  for (int64_t i = 0; i < count; ++i) {
    const Json& node = (*Member(document.json(), "nodes"))[static_cast<size_t>(i)];
    absl::StatusOr<Eigen::Matrix4d> local = LocalMatrix(node, absl::StrFormat("nodes[%d]", i));
    if (!local.ok()) return local.status();
    nodes.world_from_node[i] = *local;
    absl::StatusOr<std::vector<int64_t>> below = Indices(document, node, "children");
    if (!below.ok()) return below.status();
    children[i] = *std::move(below);
    for (const int64_t child : children[i]) {
      if (parents[child] >= 0) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "nodes[%d] is a child of nodes[%d] and of nodes[%d]", child, parents[child], i));
      }
      parents[child] = i;
    }
  }
  // Every node once, parents first; what is not reached from a root goes round in a circle.
  std::vector<int64_t> pending;
  for (int64_t i = count; i-- > 0;) {
    if (parents[i] < 0) pending.push_back(i);
  }
  int64_t num_placed = 0;
  while (!pending.empty()) {
    const int64_t node = pending.back();
    pending.pop_back();
    ++num_placed;
    if (parents[node] >= 0) {
      nodes.world_from_node[node] =
          nodes.world_from_node[parents[node]] * nodes.world_from_node[node];
    }
    for (auto child = children[node].rbegin(); child != children[node].rend(); ++child) {
      pending.push_back(*child);
    }
  }
  if (num_placed < count) {
    return absl::InvalidArgumentError("has nodes that are their own ancestors; it is damaged");
  }
  const absl::StatusOr<std::vector<int64_t>> roots = RootsShown(document, parents);
  if (!roots.ok()) return roots.status();
  std::vector<bool> is_shown(count, false);
  pending.assign(roots->rbegin(), roots->rend());
  while (!pending.empty()) {
    const int64_t index = pending.back();
    pending.pop_back();
    const Json& node = (*Member(document.json(), "nodes"))[static_cast<size_t>(index)];
    const Json* visibility = Extension(node, "KHR_node_visibility");
    if (is_shown[index] || (visibility != nullptr && !FlagIn(*visibility, "visible", true))) {
      continue;
    }
    is_shown[index] = true;
    nodes.shown.push_back(index);
    for (auto child = children[index].rbegin(); child != children[index].rend(); ++child) {
      pending.push_back(*child);
    }
  }
  return nodes;
}

}  // namespace lightfit::gltf
