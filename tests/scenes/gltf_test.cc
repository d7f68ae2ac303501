// What a glTF file may ask for; tests/python/scenes_test.py compares whole files with another
// reader.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "scenes/scene_file.h"
#include "tests/scenes/glb_bytes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using testing::BytesOf;
using testing::GlbOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

// One triangle: positions, then indices.
std::string Buffer() {
  return BytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + BytesOf<uint16_t>({0, 1, 2});
}

constexpr char kJson[] =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42}]})";

class GltfTest : public ::testing::Test {
 protected:
  absl::StatusOr<SceneFile> Read(const std::string& json, const std::string& buffer = Buffer()) {
    WriteFile(folder_.Path("a.glb"), GlbOf(json, buffer));
    return ReadScene(folder_.Path("a.glb"));
  }

  // kJson with replacements.
  absl::StatusOr<SceneFile> ReadWith(
      const std::vector<std::pair<std::string, std::string>>& replacements) {
    for (const auto& [from, to] : replacements) EXPECT_THAT(kJson, HasSubstr(from));
    return Read(absl::StrReplaceAll(kJson, replacements));
  }

  TemporaryFolder folder_;
};

TEST_F(GltfTest, ReadsATriangle) {
  const auto file = Read(kJson);
  ASSERT_THAT(file, IsOk());
  EXPECT_EQ(file->scene.triangles.size(), 1u);
}

TEST_F(GltfTest, RefusesRequiredExtensionsThatItDoesNotKnowByName) {
  const std::string head = R"("asset":{"version":"2.0"},)";
  for (const char* name : {"CESIUM_RTC", "FOO_bent_meshes", "KHR_gaussian_splatting", ""}) {
    EXPECT_THAT(
        ReadWith({{head, absl::StrCat(head, R"("extensionsRequired":[")", name, R"("],)")}}),
        StatusIs(kInvalid, AllOf(HasSubstr("requires"), HasSubstr(name), HasSubstr("a.glb"))));
  }
  for (const char* name : {"KHR_texture_transform",
                           "KHR_materials_unlit",
                           "KHR_materials_variants",
                           "KHR_texture_basisu",
                           "EXT_texture_webp",
                           "KHR_mesh_quantization",
                           "KHR_lights_punctual"}) {
    EXPECT_THAT(
        ReadWith({{head, absl::StrCat(head, R"("extensionsRequired":[")", name, R"("],)")}}),
        IsOk())
        << name;
  }
  // What is not required may be left out.
  EXPECT_THAT(ReadWith({{head, head + R"("extensionsUsed":["FOO_bent_meshes"],)"}}), IsOk());
}

TEST_F(GltfTest, LeavesOutNodesThatAreHiddenOrNotInTheScene) {
  const std::string nodes = R"("nodes":[{"mesh":0}])", roots = R"("nodes":[0])";
  const std::string hidden = R"("extensions":{"KHR_node_visibility":{"visible":false}})";
  const auto two = ReadWith({{nodes,
                              absl::StrCat(R"("nodes":[{"mesh":0,"children":[1,2]},{"mesh":0},{)",
                                           hidden,
                                           R"(,"children":[3]},{"mesh":0},{"mesh":0}])")}});
  ASSERT_THAT(two, IsOk());
  EXPECT_EQ(two->scene.triangles.size(), 2u);
}

TEST_F(GltfTest, RefusesWhatIsNoTree) {
  const std::string nodes = R"("nodes":[{"mesh":0}])";
  EXPECT_THAT(ReadWith({{nodes, R"("nodes":[{"mesh":0,"children":[0]}])"}}),
              StatusIs(kInvalid, HasSubstr("ancestors")));
  EXPECT_THAT(ReadWith({{nodes, R"("nodes":[{"children":[1]},{"children":[0],"mesh":0}])"}}),
              StatusIs(kInvalid, HasSubstr("ancestors")));
  EXPECT_THAT(ReadWith({{nodes, R"("nodes":[{"children":[2]},{"children":[2]},{"mesh":0}])"}}),
              StatusIs(kInvalid, HasSubstr("nodes[2] is a child of nodes[0] and of nodes[1]")));
  for (const char* child : {"7", "-1", "0.5", "\"a\"", "null", "1e30"}) {
    EXPECT_THAT(
        ReadWith({{nodes, absl::StrCat(R"("nodes":[{"mesh":0,"children":[)", child, "]}]")}}),
        StatusIs(kInvalid, HasSubstr("but has 1")))
        << child;
  }
}

// Depth of nodes and of JSON must not be depth of the stack.
TEST_F(GltfTest, ReadsDeepNesting) {
  std::string nodes = R"("nodes":[)";
  constexpr int kDepth = 100000;
  for (int i = 0; i < kDepth; ++i) absl::StrAppend(&nodes, R"({"children":[)", i + 1, "]},");
  const auto deep = ReadWith({{R"("nodes":[{"mesh":0}])", nodes + R"({"mesh":0}])"}});
  ASSERT_THAT(deep, IsOk());
  EXPECT_EQ(deep->scene.triangles.size(), 1u);
  const std::string lists = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_THAT(ReadWith({{R"({"version":"2.0"})", R"({"version":"2.0","extras":)" + lists + "}"}}),
              IsOk());
  EXPECT_THAT(Read(std::string(1 << 20, '[')), StatusIs(kInvalid, HasSubstr("JSON")));
}

TEST_F(GltfTest, RefusesAccessorsBeyondTheirBytes) {
  const std::string count = R"("componentType":5126,"count":3)";
  for (const char* more : {R"("componentType":5126,"count":4)",
                           R"("componentType":5126,"count":9007199254740992)",
                           R"("componentType":5126,"count":3,"byteOffset":1)",
                           R"("componentType":5126,"count":3,"byteOffset":9007199254740992)"}) {
    EXPECT_THAT(ReadWith({{count, more}}), StatusIs(kInvalid, HasSubstr("do not fit"))) << more;
  }
  for (const char* more : {R"("componentType":5126,"count":-3)",
                           R"("componentType":5126,"count":3.5)",
                           R"("componentType":5126,"count":"3")",
                           R"("componentType":5127,"count":3)",
                           R"("componentType":5126)"}) {
    EXPECT_THAT(ReadWith({{count, more}}), StatusIs(kInvalid, HasSubstr("accessors[0]"))) << more;
  }
  for (const char* view : {R"({"buffer":0,"byteLength":36,"byteStride":4})",
                           R"({"buffer":0,"byteLength":36,"byteStride":13})",
                           R"({"buffer":0,"byteLength":43})",
                           R"({"buffer":0,"byteOffset":40,"byteLength":36})",
                           R"({"buffer":0,"byteOffset":9007199254740992,"byteLength":36})",
                           R"({"buffer":1,"byteLength":36})",
                           R"({"byteLength":36})"}) {
    EXPECT_THAT(ReadWith({{R"({"buffer":0,"byteLength":36})", view}}),
                StatusIs(kInvalid, HasSubstr("a.glb")))
        << view;
  }
  EXPECT_THAT(
      ReadWith({{R"("buffers":[{"byteLength":42}])", R"("buffers":[{"byteLength":4000000000}])"}}),
      StatusIs(kInvalid, HasSubstr("4000000000")));
  // Corners that are not there are dropped and counted.
  const auto bad =
      Read(kJson, BytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + BytesOf<uint16_t>({0, 1, 3}));
  EXPECT_THAT(bad, StatusIs(kInvalid, HasSubstr("none of its 1 triangles")));
}

// Zeros, instances and repeated meshes cost a file next to nothing.
TEST_F(GltfTest, RefusesHugeCountsBeforeTakingMemory) {
  EXPECT_THAT(ReadWith({{R"("bufferView":0,"componentType":5126,"count":3)",
                         R"("componentType":5126,"count":2000000000)"}}),
              StatusIs(kInvalid, HasSubstr("out of proportion")));
  std::string meshes = R"("primitives":[)";
  for (int i = 0; i < 2000; ++i) {
    absl::StrAppend(&meshes, i == 0 ? "" : ",", R"({"attributes":{"POSITION":0},"indices":2})");
  }
  const std::string accessor = R"(,{"componentType":5125,"count":3000000,"type":"SCALAR"}])";
  EXPECT_THAT(
      ReadWith({{R"("primitives":[{"attributes":{"POSITION":0},"indices":1}])", meshes + "]"},
                {R"("count":3,"type":"SCALAR"}])", R"("count":3,"type":"SCALAR"})" + accessor}}),
      StatusIs(kInvalid, HasSubstr("a.glb")));
  const std::string instancing =
      R"("nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}])";
  EXPECT_THAT(
      ReadWith(
          {{R"("nodes":[{"mesh":0}])", instancing},
           {R"("count":3,"type":"SCALAR"}])",
            R"("count":3,"type":"SCALAR"},{"componentType":5126,"count":600000,"type":"VEC3"}])"}}),
      StatusIs(kInvalid, HasSubstr("want fewer")));
}

TEST_F(GltfTest, NamesBuffersThatAreNotThere) {
  const std::string buffer = R"("buffers":[{"byteLength":42}])";
  const auto with_uri = [&](const std::string& uri) {
    const std::string json = absl::StrReplaceAll(
        kJson, {{buffer, absl::StrCat(R"("buffers":[{"byteLength":42,"uri":")", uri, "\"}]")}});
    WriteFile(folder_.Path("a.gltf"), json);
    return ReadScene(folder_.Path("a.gltf"));
  };
  EXPECT_THAT(with_uri("none.bin"),
              StatusIs(kInvalid, AllOf(HasSubstr("none.bin"), HasSubstr("no such file"))));
  EXPECT_THAT(with_uri("https://example.org/a.bin"),
              StatusIs(kInvalid, HasSubstr("https://example.org")));
  EXPECT_THAT(with_uri("/dev/zero"), StatusIs(kInvalid, HasSubstr("no such file")));
  EXPECT_THAT(with_uri("data:application/octet-stream;base64,!!"),
              StatusIs(kInvalid, HasSubstr("base64")));
  EXPECT_THAT(with_uri("data:application/octet-stream;base64,AAAA"),
              StatusIs(kInvalid, HasSubstr("has 3 bytes")));
  WriteFile(folder_.Path("a b.bin"), Buffer());
  EXPECT_THAT(with_uri("a%20b.bin"), IsOk());
  EXPECT_THAT(with_uri("a b.bin"), IsOk());
  EXPECT_THAT(with_uri("./a%20b.bin"), IsOk());
  // Named with the percent sign itself, as some exporters do.
  WriteFile(folder_.Path("c%20d.bin"), Buffer());
  EXPECT_THAT(with_uri("c%20d.bin"), IsOk());
  EXPECT_THAT(with_uri("%"), StatusIs(kInvalid, HasSubstr("no such file")));
}

TEST_F(GltfTest, RefusesOtherVersions) {
  EXPECT_THAT(ReadWith({{R"("version":"2.0")", R"("version":"1.0")"}}),
              StatusIs(kInvalid, HasSubstr("glTF 1.0")));
  EXPECT_THAT(ReadWith({{R"("asset":{"version":"2.0"},)", ""}}),
              StatusIs(kInvalid, HasSubstr("asset.version")));
  EXPECT_THAT(Read("[]"), StatusIs(kInvalid, HasSubstr("asset.version")));
}

TEST_F(GltfTest, RefusesSkinsAndTargetsThatDoNotFit) {
  const std::string node = R"("nodes":[{"mesh":0}])";
  EXPECT_THAT(ReadWith({{node, R"("nodes":[{"mesh":0,"skin":0}])"}}),
              StatusIs(kInvalid, HasSubstr("skins[0]")));
  const std::string skin = R"("nodes":[{"mesh":0,"skin":0}],"skins":[{"joints":[)";
  EXPECT_THAT(ReadWith({{node, skin + "]}]"}}), StatusIs(kInvalid, HasSubstr("no joints")));
  EXPECT_THAT(ReadWith({{node, skin + "5]}]"}}), StatusIs(kInvalid, HasSubstr("joint 0")));
  // A mesh without joints stands where its node is.
  EXPECT_THAT(ReadWith({{node, skin + "0]}]"}}), IsOk());
  EXPECT_THAT(ReadWith({{node, skin + "0]}]"},
                        {R"({"POSITION":0})", R"({"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":1})"}}),
              StatusIs(kInvalid, HasSubstr("want 4 numbers")));
  EXPECT_THAT(ReadWith({{node, R"("nodes":[{"mesh":0,"weights":[1]}])"},
                        {R"("indices":1})", R"("indices":1,"targets":[{"POSITION":1}]})"}}),
              StatusIs(kInvalid, HasSubstr("want 3 numbers")));
}

}  // namespace
}  // namespace lightfit
