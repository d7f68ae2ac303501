#include "scenes/gltf/lights.h"

#include <map>
#include <set>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit::gltf {

namespace {

// The first name that there is, of reasonable length.
std::string NameOf(const Json& node, const Json& object, const std::string& otherwise) {
  constexpr size_t kMaxBytes = 128;
  std::string name = TextIn(node, "name");
  if (name.empty()) name = TextIn(object, "name");
  if (name.empty() || name.size() > kMaxBytes) name = otherwise;
  return name;
}

// Names that differ.
class Names {
 public:
  std::string Take(const std::string& name) {
    std::string taken = name;
    while (!names_.insert(taken).second) taken = absl::StrCat(name, "_", ++counts_[name] + 1);
    return taken;
  }

 private:
  std::set<std::string> names_;
  std::map<std::string, int> counts_;  // how often a name was found taken
};

absl::StatusOr<CameraNode> CameraOf(const Json& camera, const std::string& where) {
  CameraNode node;
  const std::string type = TextIn(camera, "type");
  node.is_perspective = type != "orthographic";
  const Json* lens = Member(camera, "perspective");
  if (!node.is_perspective) return node;
  if (lens == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(where, ": want perspective with yfov"));
  }
  const absl::StatusOr<double> fov = NumberIn(*lens, "yfov", where);
  if (!fov.ok()) return fov.status();
  const absl::StatusOr<double> aspect = NumberIn(*lens, "aspectRatio", where, 0.0);
  if (!aspect.ok()) return aspect.status();
  const absl::StatusOr<double> near = NumberIn(*lens, "znear", where, 0.0);
  if (!near.ok()) return near.status();
  const absl::StatusOr<double> far = NumberIn(*lens, "zfar", where, 0.0);
  if (!far.ok()) return far.status();
  constexpr double kPi = 3.14159265358979323846, kMaxAspect = 1e4;
  if (!(*fov > 0.0 && *fov < kPi) || !(*aspect >= 0.0 && *aspect <= kMaxAspect) ||
      (*aspect > 0.0 && *aspect < 1.0 / kMaxAspect) || !(*near >= 0.0) || !(*far >= 0.0) ||
      (*far > 0.0 && *far <= *near)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: yfov = %g, aspectRatio = %g, znear = %g, zfar = %g is no camera",
                        where,
                        *fov,
                        *aspect,
                        *near,
                        *far));
  }
  node.vertical_fov_rad = *fov;
  if (*aspect > 0.0) node.aspect = *aspect;
  node.near = *near;
  if (*far > 0.0) node.far = *far;
  return node;
}

}  // namespace

absl::StatusOr<std::vector<Light>> ReadLights(const Document& document, const Nodes& nodes) {
  std::vector<Light> lights;
  const Json* root = Extension(document.json(), "KHR_lights_punctual");
  Names names;
  for (const int64_t index : nodes.shown) {
    const Json& node = (*Member(document.json(), "nodes"))[static_cast<size_t>(index)];
    const Json* extension = Extension(node, "KHR_lights_punctual");
    if (extension == nullptr) continue;
    const std::string where = absl::StrFormat("nodes[%d]", index);
    const absl::StatusOr<int64_t> number = IntegerIn(*extension, "light", where);
    if (!number.ok()) return number.status();
    const int64_t count = root == nullptr ? 0 : LengthOf(*root, "lights");
    if (*number >= count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: light %d of %d", where, *number, count));
    }
    const Json& light = (*Member(*root, "lights"))[static_cast<size_t>(*number)];
    const std::string name = names.Take(NameOf(node, light, absl::StrCat("light", index)));
    const std::string type = TextIn(light, "type");
    const Eigen::Matrix4d& world_from_node = nodes.world_from_node[index];
    if (type == "directional") {
      lights.push_back(
          Light::Directional(name, -world_from_node.block<3, 1>(0, 2).stableNormalized()));
    } else if (type == "point" || type == "spot") {
      lights.push_back(Light::Point(name, world_from_node.block<3, 1>(0, 3)));
    } else {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": type = \"%s\", want point, spot or directional",
                          absl::CHexEscape(name),
                          absl::CHexEscape(type.substr(0, 40))));
    }
    if (absl::Status status = ValidateLight(lights.back()); !status.ok()) return status;
  }
  return lights;
}

absl::StatusOr<std::vector<CameraNode>> ReadCameras(const Document& document, const Nodes& nodes) {
  std::vector<CameraNode> cameras;
  Names names;
  for (const int64_t index : nodes.shown) {
    const Json& node = (*Member(document.json(), "nodes"))[static_cast<size_t>(index)];
    if (Member(node, "camera") == nullptr) continue;
    const std::string where = absl::StrFormat("nodes[%d]", index);
    const absl::StatusOr<int64_t> number = IntegerIn(node, "camera", where);
    if (!number.ok()) return number.status();
    const absl::StatusOr<const Json*> json = document.Element("cameras", *number);
    if (!json.ok()) return json.status();
    absl::StatusOr<CameraNode> camera = CameraOf(**json, absl::StrFormat("cameras[%d]", *number));
    if (!camera.ok()) return camera.status();
    camera->name = names.Take(NameOf(node, **json, absl::StrCat("camera", index)));
    camera->world_from_camera = nodes.world_from_node[index];
    cameras.push_back(*std::move(camera));
  }
  return cameras;
}

}  // namespace lightfit::gltf
