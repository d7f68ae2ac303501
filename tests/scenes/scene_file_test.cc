#include "scenes/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "absl/strings/str_cat.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

class SceneFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = std::filesystem::temp_directory_path() / "lightfit_scene_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& bytes) const {
    const std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::filesystem::path folder_;
};

// A quad, a triangle, a triangle without area, and a line.
constexpr char kObj[] =
    "# a comment\n"
    "v 0 0 0\nv 2 0 0\nv 2 0 3\nv 0 0 3\nv 0 5 0\n"
    "f 1 2 3 4\n"
    "f 1 2 5\n"
    "f 1 1 2\n"
    "l 1 2\n";

constexpr char kPly[] =
    "ply\nformat ascii 1.0\n"
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\n"
    "end_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 -7\n"
    "3 0 1 2\n3 0 1 3\n";

// One triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) with 16-bit indices, 44 bytes.
std::string GltfBuffer() {
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const uint16_t indices[4] = {0, 1, 2, 0};
  std::string bytes(44, '\0');
  std::memcpy(bytes.data(), positions, 36);
  std::memcpy(bytes.data() + 36, indices, 8);
  return bytes;
}

// Two nodes show the one mesh: one moved by (10, 0, 0), the other doubled inside a parent that is
// moved by (0, 100, 0).
std::string GltfJson(const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
 "nodes": [{"mesh": 0, "translation": [10, 0, 0]},
           {"children": [2], "translation": [0, 100, 0]}, {"mesh": 0, "scale": [2, 2, 2]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]},
               {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36},
                 {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
 "buffers": [{)" +
         buffer + R"("byteLength": 44}]})";
}

std::string Glb() {
  std::string json = GltfJson("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string buffer = GltfBuffer();
  std::string glb = "glTF";
  const auto append = [&glb](uint32_t word) {
    glb.append(reinterpret_cast<const char*>(&word), sizeof(word));
  };
  append(2);
  append(static_cast<uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(static_cast<uint32_t>(json.size()));
  glb += "JSON";
  glb += json;
  append(static_cast<uint32_t>(buffer.size()));
  glb += std::string("BIN\0", 4);
  glb += buffer;
  return glb;
}

void ExpectBounds(const Scene& scene, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  const Eigen::AlignedBox3d bounds = BoundsOf(scene);
  EXPECT_LE((bounds.min() - min).norm(), 1e-5) << bounds.min().transpose();
  EXPECT_LE((bounds.max() - max).norm(), 1e-5) << bounds.max().transpose();
}

TEST_F(SceneFileTest, ReadsObjPolygonsAndDropsWhatHasNoArea) {
  const auto file = ReadScene(Write("a.obj", kObj));
  ASSERT_THAT(file, IsOk());
  EXPECT_EQ(file->scene.triangles.size(), 3u);
  ExpectBounds(file->scene, {0, 0, 0}, {2, 5, 3});
}

TEST_F(SceneFileTest, ReadsPly) {
  const auto file = ReadScene(Write("a.ply", kPly));
  ASSERT_THAT(file, IsOk());
  EXPECT_EQ(file->scene.triangles.size(), 2u);
  EXPECT_EQ(file->num_dropped, 0);
  ExpectBounds(file->scene, {0, 0, -7}, {1, 1, 0});
}

TEST_F(SceneFileTest, ReadsBinaryPlyOfBothEnds) {
  for (const bool is_big : {false, true}) {
    std::string ply = absl::StrCat("ply\r\nformat binary_",
                                   is_big ? "big" : "little",
                                   "_endian 1.0\ncomment made by hand\n"
                                   "element vertex 4\nproperty double x\nproperty uchar red\n"
                                   "property float y\nproperty float z\n"
                                   "element face 1\nproperty short flags\n"
                                   "property list uchar uint vertex_index\nend_header\n");
    const auto append = [&ply, is_big](const auto& value) {
      char bytes[sizeof(value)];
      std::memcpy(bytes, &value, sizeof(value));
      if (is_big) std::reverse(bytes, bytes + sizeof(value));
      ply.append(bytes, sizeof(value));
    };
    for (const Eigen::Vector3f& vertex : {Eigen::Vector3f(-1, 2, 3),
                                          Eigen::Vector3f(5, 2, 3),
                                          Eigen::Vector3f(5, 8, 3),
                                          Eigen::Vector3f(-1, 8, 4)}) {
      append(static_cast<double>(vertex.x()));
      append(static_cast<uint8_t>(200));
      append(vertex.y());
      append(vertex.z());
    }
    append(static_cast<int16_t>(-7));
    append(static_cast<uint8_t>(4));
    for (const uint32_t index : {0U, 1U, 2U, 3U}) append(index);
    const auto file = ReadScene(Write("a.ply", ply));
    ASSERT_THAT(file, IsOk());
    EXPECT_EQ(file->scene.triangles.size(), 2u);
    ExpectBounds(file->scene, {-1, 2, 3}, {5, 8, 4});
    ply.pop_back();
    EXPECT_THAT(ReadScene(Write("a.ply", ply)), StatusIs(kInvalid, HasSubstr("face 1 of 1")));
  }
}

// The header knows of x, y and z; each line has a colour too, and a face its own.
TEST_F(SceneFileTest, LeavesOutWhatPlyLinesHaveBeyondTheHeader) {
  const auto file = ReadScene(Write("a.ply",
                                    "ply\nformat ascii 1.0\n"
                                    "element vertex 4\nproperty float x\nproperty float y\n"
                                    "property float z\nelement face 2\n"
                                    "property list uchar int vertex_indices\nend_header\n"
                                    "0 0 0 255 0 0\r\n1 0 0 0 255 0\n\n0 1 0 1 2 3 4 5\n0 0 -7\n"
                                    "3 0 1 2 9 9 9\n3 0 1 3 9 9 9"));
  ASSERT_THAT(file, IsOk());
  EXPECT_THAT(file->scene.triangles,
              ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 1, 3)));
  ExpectBounds(file->scene, {0, 0, -7}, {1, 1, 0});
}

// -1 ends a strip, every other triangle of one is turned, and a repeated corner is none.
TEST_F(SceneFileTest, ReadsPlyStrips) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\n";
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 1\n";
  for (const char* list : {"property list int int vertex_indices\nend_header\n",
                           "property list uchar int vertex_index\nend_header\n",
                           "property list int int indices\nend_header\n"}) {
    const auto file =
        ReadScene(Write("a.ply", header + list + vertices + "13 0 1 2 3 -1 2 3 4 4 5 -1 0 1\n"));
    ASSERT_THAT(file, IsOk());
    EXPECT_THAT(
        file->scene.triangles,
        ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(2, 1, 3), Eigen::Vector3i(2, 3, 4)));
    EXPECT_EQ(file->num_dropped, 0);
  }
  EXPECT_THAT(ReadScene(Write("a.ply", header + "property int a\nend_header\n" + vertices + "7\n")),
              StatusIs(kInvalid, HasSubstr("no list vertex_indices")));
}

TEST_F(SceneFileTest, ReadsPlyFacesThatStandBeforeTheirVertices) {
  const auto file = ReadScene(Write("a.ply",
                                    "ply\nformat ascii 1.0\nelement face 1\n"
                                    "property list uchar int vertex_indices\n"
                                    "element vertex 5\nproperty double x\nproperty double y\n"
                                    "property double z\nend_header\n5 0 1 2 3 4\n"
                                    "0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n"));
  ASSERT_THAT(file, IsOk());
  EXPECT_EQ(file->scene.triangles.size(), 3u);
}

// Editors and shells of Windows.
TEST_F(SceneFileTest, ReadsTextWithMarksAndOfSixteenBits) {
  const std::string mark = "\xEF\xBB\xBF";
  Write("a.bin", GltfBuffer());
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"a.obj", kObj},
                                   {"a.ply", kPly},
                                   {"a.gltf", GltfJson("\"uri\": \"a.bin\", ")}}) {
    SCOPED_TRACE(name);
    std::string wide = "\xFF\xFE";
    for (const char c : text) wide += std::string{c, '\0'};
    const auto plain = ReadScene(Write(name, text));
    ASSERT_THAT(plain, IsOk());
    for (const std::string& bytes : {mark + text, wide}) {
      const auto file = ReadScene(Write(name, bytes));
      ASSERT_THAT(file, IsOk());
      EXPECT_EQ(file->scene.vertices, plain->scene.vertices);
      EXPECT_EQ(file->scene.triangles, plain->scene.triangles);
    }
  }
}

TEST_F(SceneFileTest, ReadsGltfAndGlbUnderTheirNodes) {
  Write("a.bin", GltfBuffer());
  for (const std::string& path : {Write("a.gltf", GltfJson("\"uri\": \"a.bin\", ")),
                                  Write("a.glb", Glb()),
                                  Write("B.GLB", Glb())}) {
    SCOPED_TRACE(path);
    const auto file = ReadScene(path);
    ASSERT_THAT(file, IsOk());
    EXPECT_EQ(file->scene.triangles.size(), 2u);
    ExpectBounds(file->scene, {0, 0, 0}, {11, 102, 0});
  }
}

TEST_F(SceneFileTest, NamesFilesThatAreNotThere) {
  EXPECT_THAT(ReadScene(folder_ / "none.glb"),
              StatusIs(absl::StatusCode::kNotFound,
                       AllOf(HasSubstr("none.glb"), HasSubstr("no such file"))));
  EXPECT_THAT(ReadScene(folder_), StatusIs(kInvalid, HasSubstr("folder")));
}

TEST_F(SceneFileTest, RefusesOtherFormatsByName) {
  for (const char* name : {"a.blend", "a.fbx", "a", "a.exr", "a.txt"}) {
    EXPECT_THAT(ReadScene(Write(name, kObj)),
                StatusIs(kInvalid, AllOf(HasSubstr(name), HasSubstr("convert"))));
  }
}

TEST_F(SceneFileTest, RefusesWhatIsNotTheFormatOfItsName) {
  EXPECT_THAT(ReadScene(Write("a.glb", kObj)), StatusIs(kInvalid, HasSubstr("no GLB")));
  EXPECT_THAT(ReadScene(Write("a.ply", kObj)), StatusIs(kInvalid, HasSubstr("no PLY")));
  EXPECT_THAT(ReadScene(Write("a.gltf", "not json")), StatusIs(kInvalid, HasSubstr("a.gltf")));
  EXPECT_THAT(ReadScene(Write("a.obj", "some text\nand more\n")),
              StatusIs(kInvalid, HasSubstr("a.obj")));
  for (const char* name : {"e.glb", "e.gltf", "e.obj", "e.ply"}) {
    EXPECT_THAT(ReadScene(Write(name, "")), StatusIs(kInvalid, HasSubstr("empty")));
  }
}

TEST_F(SceneFileTest, RefusesScenesWithoutTriangles) {
  EXPECT_THAT(ReadScene(Write("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")),
              StatusIs(kInvalid, HasSubstr("a.obj")));
  EXPECT_THAT(ReadScene(Write("b.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n")),
              StatusIs(kInvalid, AllOf(HasSubstr("b.obj"), HasSubstr("area"))));
  EXPECT_THAT(ReadScene(Write("c.ply",
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                              "property float y\nproperty float z\nend_header\n0 0 0\n")),
              StatusIs(kInvalid, HasSubstr("c.ply")));
}

TEST_F(SceneFileTest, RefusesHugeCountsBeforeTakingMemory) {
  for (const char* count : {"4000000000", "999999999999", "-5", "99999999999999999999999"}) {
    std::string ply = kPly;
    ply.replace(ply.find("vertex 4") + 7, 1, count);
    EXPECT_THAT(ReadScene(Write("a.ply", ply)),
                StatusIs(kInvalid, AllOf(HasSubstr("element vertex"), HasSubstr("cannot hold"))));
  }
  std::string gltf = GltfJson("\"uri\": \"a.bin\", ");
  gltf.replace(gltf.find("\"count\": 3"), 10, "\"count\": 2000000000");
  Write("a.bin", GltfBuffer());
  EXPECT_THAT(ReadScene(Write("a.gltf", gltf)), StatusIs(kInvalid, HasSubstr("a.gltf")));
}

// Damaged files give a scene or an error, whatever the damage.
TEST_F(SceneFileTest, SurvivesFilesThatAreCutShort) {
  int num_errors = 0;
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"a.glb", Glb()}, {"a.ply", kPly}, {"a.obj", kObj}}) {
    for (size_t length = 1; length < bytes.size(); length += 1 + bytes.size() / 60) {
      const auto file = ReadScene(Write(name, bytes.substr(0, length)));
      if (file.ok()) {
        EXPECT_FALSE(file->scene.triangles.empty());
      } else {
        ++num_errors;
        EXPECT_THAT(file.status().message(), HasSubstr(name));
      }
    }
  }
  EXPECT_GT(num_errors, 60);
}

TEST_F(SceneFileTest, SurvivesDamagedBytes) {
  constexpr int kSeed = 81;
  std::printf("[   seed   ] %d\n", kSeed);
  std::mt19937 random(kSeed);
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"a.glb", Glb()}, {"a.ply", kPly}, {"a.obj", kObj}}) {
    for (int i = 0; i < 100; ++i) {
      std::string damaged = bytes;
      for (int flips = 1 + random() % 4; flips > 0; --flips) {
        damaged[random() % damaged.size()] = static_cast<char>(random() & 0xff);
      }
      const auto file = ReadScene(Write(name, damaged));
      if (file.ok()) {
        EXPECT_FALSE(file->scene.triangles.empty());
        EXPECT_TRUE(BoundsOf(file->scene).min().allFinite());
      }
    }
  }
}

struct SharedSceneFacts {
  const char* name;
  size_t num_triangles;
  Eigen::Vector3d min, max;  // rounded to centimetres
};

TEST(SharedScenes, HaveTheTrianglesAndBoundsOfTheirList) {
  const SharedSceneFacts kScenes[] = {
      {"sponza_atrium", 50559, {-14.32, -0.03, -6.52}, {13.16, 13.14, 6.05}},
      {"denhaag_city", 41183, {-393.68, 0.00, -335.92}, {393.68, 35.02, 335.92}},
      {"forest_valley", 256816, {-2197.30, -5.00, -2222.64}, {2197.30, 427.00, 2222.64}},
      {"objects_floor", 119962, {-4.00, 0.00, -4.00}, {4.00, 2.20, 4.00}},
      {"hotel_room", 98953, {-3.24, 0.00, -5.00}, {3.24, 2.20, 5.00}},
      {"shadow_columns", 16362, {-231.44, -6.87, -29.55}, {231.44, 9.38, 29.55}}};
  if (!std::filesystem::exists(testing::SharedScene("objects_floor"))) {
    GTEST_SKIP() << "no ../shared/scenes: the development scenes are not part of the repository";
  }
  for (const SharedSceneFacts& expected : kScenes) {
    SCOPED_TRACE(expected.name);
    const auto file = ReadScene(testing::SharedScene(expected.name));
    ASSERT_THAT(file, IsOk());
    EXPECT_EQ(file->scene.triangles.size() + file->num_dropped, expected.num_triangles);
    EXPECT_LE(file->num_dropped, 0);
    const Eigen::AlignedBox3d bounds = BoundsOf(file->scene);
    EXPECT_LE((bounds.min() - expected.min).cwiseAbs().maxCoeff(), 0.0051);
    EXPECT_LE((bounds.max() - expected.max).cwiseAbs().maxCoeff(), 0.0051);
  }
}

}  // namespace
}  // namespace lightfit
