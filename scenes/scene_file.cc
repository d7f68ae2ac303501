#include "scenes/scene_file.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_encoding.h"
#include "scenes/gltf/document.h"
#include "scenes/gltf/meshes.h"
#include "scenes/gltf/nodes.h"
#include "scenes/obj_file.h"
#include "scenes/ply_file.h"

namespace lightfit {

namespace {

absl::Status Refuse(const std::string& path, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("scene ", path, ": ", what));
}

std::string ExtensionOf(const std::string& path) {
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
}

// What can be told from the name and the first bytes.
absl::Status CheckFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(
        "scene ", path, ": there is no such file, want a .glb, .gltf, .obj or .ply file"));
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    return Refuse(path, "is a folder or a device, want a .glb, .gltf, .obj or .ply file");
  }
  const std::string extension = ExtensionOf(path);
  if (extension != ".glb" && extension != ".gltf" && extension != ".obj" && extension != ".ply") {
    return Refuse(
        path,
        absl::StrCat(
            "its name ends in \"", extension, "\", want .glb, .gltf, .obj or .ply: convert it"));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return Refuse(path, "cannot be opened for reading; are its permissions right?");
  const auto num_bytes = static_cast<int64_t>(std::filesystem::file_size(path, error));
  if (error || num_bytes == 0) return Refuse(path, "is empty");
  char start[4] = {};
  file.read(start, sizeof(start));
  const absl::string_view magic(start, file.gcount());
  if (extension == ".glb" && magic != "glTF") {
    return Refuse(path, "does not begin with \"glTF\", so it is no GLB file");
  }
  return absl::OkStatus();
}

absl::StatusOr<SceneFile> Checked(SceneFile file, const std::string& path) {
  file.num_dropped += DropBadTriangles(&file.scene);
  if (file.scene.triangles.empty()) {
    return Refuse(path,
                  file.num_dropped > 0
                      ? absl::StrFormat("none of its %d triangles has an area and finite corners",
                                        file.num_dropped)
                      : "has no triangle; points, lines and curves are left out");
  }
  return file;
}

absl::StatusOr<SceneFile> ReadText(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  const absl::StatusOr<std::string> text = DecodeText(std::move(bytes));
  if (!text.ok()) return Refuse(path, text.status().message());
  const bool is_ply = ExtensionOf(path) == ".ply";
  if (is_ply && !absl::StartsWith(*text, "ply")) {
    return Refuse(path, "does not begin with \"ply\", so it is no PLY file");
  }
  absl::StatusOr<Scene> scene = is_ply ? ParsePly(*text) : ParseObj(*text);
  if (!scene.ok()) return Refuse(path, scene.status().message());
  SceneFile file;
  file.scene = *std::move(scene);
  return Checked(std::move(file), path);
}

absl::StatusOr<SceneFile> ReadGltf(const std::string& path) {
  absl::StatusOr<gltf::Document> document = gltf::Document::Read(path);
  if (!document.ok()) return Refuse(path, document.status().message());
  const absl::StatusOr<gltf::Nodes> nodes = gltf::ReadNodes(*document);
  if (!nodes.ok()) return Refuse(path, nodes.status().message());
  absl::StatusOr<gltf::Shown> shown = gltf::ReadMeshes(&*document, *nodes);
  if (!shown.ok()) return Refuse(path, shown.status().message());
  SceneFile file;
  file.num_dropped = shown->num_bad_triangles;
  file.scene = MakeScene(shown->vertices, std::move(shown->triangles));
  return Checked(std::move(file), path);
}

}  // namespace

absl::StatusOr<SceneFile> ReadScene(const std::string& path) {
  if (absl::Status status = CheckFile(path); !status.ok()) return status;
  try {
    return absl::StartsWith(ExtensionOf(path), ".gl") ? ReadGltf(path) : ReadText(path);
  } catch (const std::exception& error) {
    // When memory runs out.
    return Refuse(path, absl::StrCat("cannot be read (", error.what(), ")"));
  }
}

}  // namespace lightfit
