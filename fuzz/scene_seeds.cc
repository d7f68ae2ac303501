#include "fuzz/scene_seeds.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace lightfit::fuzz {
namespace {

using SceneInputs = std::vector<std::pair<std::string, std::string>>;

void AddPly(SceneInputs* seeds) {
  seeds->emplace_back(
      "ply/text",
      "ply\nformat ascii 1.0\ncomment two triangles and a square\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n3 0 1 2\n3 0 2 3\n4 0 1 2 3\n");
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
      "property double x\nproperty float y\nproperty short z\n"
      "element face 1\nproperty uchar flags\nproperty list int uint vertex_index\nend_header\n";
  for (int i = 0; i < 3; ++i) {
    const double x = i;
    const float y = i == 1 ? 1.0F : 0.0F;
    const int16_t z = 2;
    binary.append(reinterpret_cast<const char*>(&x), sizeof(x));
    binary.append(reinterpret_cast<const char*>(&y), sizeof(y));
    binary.append(reinterpret_cast<const char*>(&z), sizeof(z));
  }
  binary.push_back('\1');
  for (const int32_t word : {3, 0, 1, 2}) {
    binary.append(reinterpret_cast<const char*>(&word), sizeof(word));
  }
  seeds->emplace_back("ply/binary", binary);
}

void AddObj(SceneInputs* seeds) {
  seeds->emplace_back(
      "obj/forms",
      "# a square, a notch and what is left out\nv 0 0 0\nv +1 .5 0 1.0\nv 1e0 1. 0 0.1 0.2 0.3\n"
      "v 0 1 0\nv .5 .6 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1 -2\nf 1 2 \\\n 3 5 4\nl 1 2\n");
}

void AddGlb(SceneInputs* seeds) {
  // Three corners, three indices, weights and joints; everything may be taken for anything.
  std::string chunk;
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0};
  chunk.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
  const uint16_t indices[] = {0, 1, 2, 0};
  chunk.append(reinterpret_cast<const char*>(indices), sizeof(indices));
  const auto save = [seeds, &chunk](const char* name, absl::string_view nodes) {
    seeds->emplace_back(
        absl::StrCat("glb/", name),
        absl::StrCat(
            R"({"asset":{"version":"2.0"},)",
            nodes,
            R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
            R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},)"
            R"({"componentType":5121,"count":3,"type":"VEC4"},)"
            R"({"componentType":5126,"count":3,"type":"VEC4","sparse":{"count":1,)"
            R"("indices":{"bufferView":1,"componentType":5123},)"
            R"("values":{"bufferView":0,"byteOffset":36}}}],)"
            R"("bufferViews":[{"buffer":0,"byteLength":52},)"
            R"({"buffer":0,"byteOffset":52,"byteLength":6}],)"
            R"("buffers":[{"byteLength":60}]})",
            absl::string_view("\0", 1),
            chunk));
  };
  const std::string mesh =
      R"("meshes":[{"weights":[0.5],"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,)"
      R"("WEIGHTS_0":3},"indices":1,"targets":[{"POSITION":0}]},{"mode":5,)"
      R"("attributes":{"POSITION":0}}]}],)";
  save("nodes", R"("nodes":[{"mesh":0,"children":[1]},{"mesh":0,"scale":[2,2,2]}],)" + mesh);
  save("skin",
       R"("nodes":[{"mesh":0,"skin":0},{"rotation":[0,0,1,0]}],"skins":[{"joints":[1]}],)" + mesh);
  save("instances",
       R"("nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)"
       R"({"TRANSLATION":0,"ROTATION":3}}}}],)" +
           mesh);
  save("view",
       R"("nodes":[{"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}},)"
       R"({"name":"sun","extensions":{"KHR_lights_punctual":{"light":1}}}],)"
       R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"aspectRatio":1.5,"znear":1}}],)"
       R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot"},)"
       R"({"type":"directional"}]}},)");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> SceneSeeds() {
  SceneInputs seeds;
  AddPly(&seeds);
  AddObj(&seeds);
  AddGlb(&seeds);
  return seeds;
}

}  // namespace lightfit::fuzz
