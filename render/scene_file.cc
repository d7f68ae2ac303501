#include "render/scene_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Core>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "render/ply_file.h"

namespace lightfit {

namespace {

// Ten times what fits into the memory of a large workstation with its tree. A node may show a mesh
// any number of times, so a small file can ask for any number of triangles.
constexpr int64_t kMaxTriangles = int64_t{1} << 28;
constexpr int64_t kMaxVertices = int64_t{1} << 29;

absl::Status Refuse(const std::string& path, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("scene ", path, ": ", what));
}

std::string ExtensionOf(const std::string& path) {
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
}

// That the chunks of a GLB file are all there: assimp takes memory for as much as they say.
absl::Status CheckGlbChunks(const std::string& path, std::ifstream& file, int64_t num_bytes) {
  const auto word = [&file] {
    unsigned char bytes[4] = {};
    file.read(reinterpret_cast<char*>(bytes), sizeof(bytes));
    return bytes[0] | int64_t{bytes[1]} << 8 | int64_t{bytes[2]} << 16 | int64_t{bytes[3]} << 24;
  };
  constexpr int64_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  const int64_t version = word(), length = word();
  if (version != 2) {
    return Refuse(path, absl::StrCat("is GLB version ", version, ", want 2: convert it"));
  }
  int64_t at = kHeaderBytes;
  while (file && at + kChunkHeaderBytes <= std::min(length, num_bytes)) {
    at += kChunkHeaderBytes + word();
    file.seekg(at);
  }
  if (length > num_bytes || at > num_bytes || at == kHeaderBytes) {
    return Refuse(path,
                  absl::StrFormat("has %d bytes, but its header says %d or more; it is damaged or "
                                  "cut short",
                                  num_bytes,
                                  std::max(length, at)));
  }
  return absl::OkStatus();
}

// What can be told from the name and the first bytes. assimp would try all of its sixty formats.
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
  if (extension == ".glb") return CheckGlbChunks(path, file, num_bytes);
  if (extension == ".ply" && magic.substr(0, 3) != "ply") {
    return Refuse(path, "does not begin with \"ply\", so it is no PLY file");
  }
  return absl::OkStatus();
}

Eigen::Matrix4d MatrixOf(const aiMatrix4x4& m) {
  Eigen::Matrix4d matrix;
  matrix << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
      m.d3, m.d4;
  return matrix;
}

// Triangles of one mesh; `*num_bad` counts those whose corners are not there.
void AppendMesh(const aiMesh& mesh,
                const Eigen::Matrix4d& world_from_mesh,
                Scene* scene,
                int64_t* num_bad) {
  const auto first = static_cast<int>(scene->vertices.size());
  for (unsigned int i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    const Eigen::Vector4d world = world_from_mesh * Eigen::Vector4d(v.x, v.y, v.z, 1.0);
    scene->vertices.push_back(world.head<3>().cast<float>());
  }
  for (unsigned int i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines
    Eigen::Vector3i triangle;
    bool good = true;
    for (int corner = 0; corner < 3; ++corner) {
      good = good && face.mIndices[corner] < mesh.mNumVertices;
      triangle[corner] = first + static_cast<int>(face.mIndices[corner]);
    }
    if (good) {
      scene->triangles.push_back(triangle);
    } else {
      ++*num_bad;
    }
  }
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

absl::StatusOr<SceneFile> ReadPly(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  absl::StatusOr<Scene> scene = ParsePly(bytes);
  if (!scene.ok()) return Refuse(path, scene.status().message());
  SceneFile file;
  file.scene = *std::move(scene);
  return Checked(std::move(file), path);
}

absl::StatusOr<SceneFile> SceneOf(const aiScene& from, const std::string& path) {
  SceneFile file;
  int64_t num_triangles = 0, num_vertices = 0;
  std::vector<std::pair<const aiNode*, Eigen::Matrix4d>> pending = {
      {from.mRootNode, Eigen::Matrix4d::Identity()}};
  while (!pending.empty()) {
    const aiNode& node = *pending.back().first;
    const Eigen::Matrix4d world_from_node = pending.back().second * MatrixOf(node.mTransformation);
    pending.pop_back();
    for (unsigned int i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= from.mNumMeshes) continue;
      const aiMesh& mesh = *from.mMeshes[node.mMeshes[i]];
      num_triangles += mesh.mNumFaces;
      num_vertices += mesh.mNumVertices;
      if (num_triangles > kMaxTriangles || num_vertices > kMaxVertices) {
        return Refuse(path,
                      absl::StrFormat("has more than %d triangles or %d vertices, want fewer: take "
                                      "a part of it",
                                      kMaxTriangles,
                                      kMaxVertices));
      }
      AppendMesh(mesh, world_from_node, &file.scene, &file.num_dropped);
    }
    // The last one first: meshes stand in the order of the file.
    for (unsigned int i = node.mNumChildren; i-- > 0;) {
      pending.emplace_back(node.mChildren[i], world_from_node);
    }
  }
  return Checked(std::move(file), path);
}

}  // namespace

absl::StatusOr<SceneFile> ReadScene(const std::string& path) {
  if (absl::Status status = CheckFile(path); !status.ok()) return status;
  try {
    if (ExtensionOf(path) == ".ply") return ReadPly(path);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      const std::string why = importer.GetErrorString();
      return Refuse(path,
                    absl::StrCat("cannot be read (",
                                 why.empty() ? "no reason given" : why,
                                 "); it is damaged, cut short, or uses an extension that is not "
                                 "supported: write it again without compression"));
    }
    return SceneOf(*scene, path);
  } catch (const std::exception& error) {
    // assimp keeps its exceptions to itself, but for some when memory runs out.
    return Refuse(path, absl::StrCat("cannot be read (", error.what(), ")"));
  }
}

}  // namespace lightfit
