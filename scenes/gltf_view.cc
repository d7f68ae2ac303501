#include "scenes/gltf_view.h"

#include <Eigen/Geometry>
#include <cmath>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "scenes/gltf/document.h"
#include "scenes/gltf/lights.h"
#include "scenes/gltf/nodes.h"

namespace lightfit {

namespace {

struct PathAndName {
  std::string path, name;
};

bool EndsLikeGltf(absl::string_view path) {
  return absl::EndsWithIgnoreCase(path, ".glb") || absl::EndsWithIgnoreCase(path, ".gltf");
}

// "scene.glb:NAME"; names may have colons, so the first that follows the file's ending counts.
PathAndName Split(absl::string_view text) {
  for (size_t at = text.find(':'); at != absl::string_view::npos; at = text.find(':', at + 1)) {
    if (EndsLikeGltf(text.substr(0, at))) {
      return {std::string(text.substr(0, at)), std::string(text.substr(at + 1))};
    }
  }
  return {std::string(text), ""};
}

// What `read` makes of the file, with its path before errors.
template <typename Read>
auto ReadFrom(const std::string& path, const Read& read)
    -> decltype(read(std::declval<const gltf::Document&>(), std::declval<const gltf::Nodes&>())) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  absl::Status status;
  try {
    const absl::StatusOr<gltf::Document> document = gltf::Document::Read(path);
    if (document.ok()) {
      const absl::StatusOr<gltf::Nodes> nodes = gltf::ReadNodes(*document);
      if (nodes.ok()) {
        auto result = read(*document, *nodes);
        if (result.ok()) return result;
        status = result.status();
      } else {
        status = nodes.status();
      }
    } else {
      status = document.status();
    }
  } catch (const std::exception& failure) {
    // When memory runs out.
    status = absl::InvalidArgumentError(failure.what());
  }
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", status.message()));
}

absl::StatusOr<gltf::CameraNode> Choose(const std::vector<gltf::CameraNode>& cameras,
                                        const std::string& path,
                                        const std::string& name) {
  if (cameras.empty()) {
    return absl::InvalidArgumentError("has no camera, want --camera EYE:TARGET or another file");
  }
  std::vector<std::string> names;
  for (const gltf::CameraNode& camera : cameras) {
    if (camera.name == name) return camera;
    names.push_back(absl::CHexEscape(camera.name));
  }
  if (name.empty() && cameras.size() == 1) return cameras[0];
  size_t number = 0;
  if (absl::SimpleAtoi(name, &number) && number < cameras.size()) return cameras[number];
  const std::string file = std::filesystem::path(path).filename().string();
  if (name.empty()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("has %d cameras, want one of them: %s:%s",
                        cameras.size(),
                        file,
                        absl::StrJoin(names, absl::StrCat(", ", file, ":"))));
  }
  return absl::InvalidArgumentError(absl::StrFormat("has no camera \"%s\", want one of %s%s",
                                                    absl::CHexEscape(name),
                                                    absl::StrJoin(names, ", "),
                                                    DidYouMean(name, names)));
}

absl::StatusOr<Camera> CameraOf(const gltf::CameraNode& node) {
  constexpr double kRightAngle = 1e-4;  // cosines between the axes
  const auto refuse = [&node](absl::string_view what) {
    return absl::InvalidArgumentError(
        absl::StrCat("camera \"", absl::CHexEscape(node.name), "\": ", what));
  };
  if (!node.is_perspective) return refuse("is orthographic, want a perspective one");
  // Scale is no part of a camera's pose.
  Eigen::Matrix3d axes = node.world_from_camera.topLeftCorner<3, 3>();
  for (int i = 0; i < 3; ++i) axes.col(i) = axes.col(i).stableNormalized().eval();
  const Eigen::Vector3d eye = node.world_from_camera.topRightCorner<3, 1>();
  if (!axes.allFinite() || !eye.allFinite() ||
      !((axes.transpose() * axes).isIdentity(kRightAngle))) {
    return refuse("its node is sheared or has no extent, want a rotation and a place");
  }
  Camera camera;
  // Right, down and forward of a camera that looks along -z with y up.
  const Eigen::Vector3d flip(1.0, -1.0, -1.0);
  camera.camera_from_world.topLeftCorner<3, 3>() = flip.asDiagonal() * axes.transpose();
  camera.camera_from_world.topRightCorner<3, 1>() =
      -(camera.camera_from_world.topLeftCorner<3, 3>() * eye);
  const double lens_y = 0.5 / std::tan(0.5 * node.vertical_fov_rad);
  camera.screen_from_camera(0, 0) = node.aspect.has_value() ? lens_y / *node.aspect : 0.0;
  camera.screen_from_camera(1, 1) = lens_y;
  camera.near = node.near;
  if (node.far.has_value()) camera.far = *node.far;
  return camera;
}

}  // namespace

bool IsGltf(absl::string_view path) { return EndsLikeGltf(Split(path).path); }

absl::StatusOr<std::string> GltfLightsJson(const std::string& path) {
  return ReadFrom(
      path,
      [](const gltf::Document& document, const gltf::Nodes& nodes) -> absl::StatusOr<std::string> {
        const absl::StatusOr<std::vector<Light>> lights = gltf::ReadLights(document, nodes);
        if (!lights.ok()) return lights.status();
        if (lights->empty()) {
          return absl::InvalidArgumentError(
              "has no lights (KHR_lights_punctual), want --light NAME=sun:X,Y,Z or another file");
        }
        gltf::Json list = gltf::Json::array();
        for (const Light& light : *lights) {
          const bool is_point = light.kind == Light::Kind::kPoint;
          const Eigen::Vector3d& vector = is_point ? light.position : light.direction;
          list.push_back(
              {{"name", light.name},
               {is_point ? "position" : "direction", {vector.x(), vector.y(), vector.z()}}});
        }
        return gltf::Json({{"lights", list}}).dump();
      });
}

absl::StatusOr<Camera> ReadGltfCamera(const std::string& path) {
  const PathAndName given = Split(path);
  return ReadFrom(
      given.path,
      [&given](const gltf::Document& document, const gltf::Nodes& nodes) -> absl::StatusOr<Camera> {
        const absl::StatusOr<std::vector<gltf::CameraNode>> cameras =
            gltf::ReadCameras(document, nodes);
        if (!cameras.ok()) return cameras.status();
        const absl::StatusOr<gltf::CameraNode> camera = Choose(*cameras, given.path, given.name);
        if (!camera.ok()) return camera.status();
        return CameraOf(*camera);
      });
}

GltfContents ContentsOf(const std::string& path) {
  const absl::StatusOr<GltfContents> contents = ReadFrom(
      path,
      [](const gltf::Document& document, const gltf::Nodes& nodes) -> absl::StatusOr<GltfContents> {
        GltfContents found;
        const absl::StatusOr<std::vector<Light>> lights = gltf::ReadLights(document, nodes);
        if (lights.ok()) found.num_lights = static_cast<int>(lights->size());
        const absl::StatusOr<std::vector<gltf::CameraNode>> cameras =
            gltf::ReadCameras(document, nodes);
        if (!cameras.ok()) return found;
        for (const gltf::CameraNode& camera : *cameras) {
          found.cameras.push_back(camera.name);
        }
        return found;
      });
  return contents.ok() ? *contents : GltfContents();
}

}  // namespace lightfit
