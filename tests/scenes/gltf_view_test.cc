#include "scenes/gltf_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>

#include "absl/strings/str_cat.h"
#include "geometry/sized_camera.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr double kTolerance = 1e-12;

// A lamp, a spot of the same name, a sun without one under a turned parent; a camera at (1, 2, 3)
// that looks along -z, another along +x, and an orthographic one.
constexpr char kNodes[] = R"("scenes":[{"nodes":[0,1,2,4,5,6]}],"nodes":[
{"name":"lamp","translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},
{"name":"lamp","translation":[4,5,6],"extensions":{"KHR_lights_punctual":{"light":1}}},
{"rotation":[0.7071067811865476,0,0,0.7071067811865476],"children":[3]},
{"scale":[2,2,2],"extensions":{"KHR_lights_punctual":{"light":2}}},
{"name":"front","translation":[1,2,3],"camera":0},
{"name":"side: left","scale":[3,3,3],"rotation":[0,-0.7071067811865476,0,0.7071067811865476],"camera":1},
{"name":"flat","camera":2},
{"name":"hidden","camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":1.5707963267948966,"aspectRatio":2,"znear":0.5,"zfar":9}},
{"type":"perspective","perspective":{"yfov":1.5707963267948966,"znear":0.1}},
{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":1}}],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"},
{"type":"spot","spot":{"outerConeAngle":0.5}},{"type":"directional","name":"sky"}]}}})";

class GltfViewTest : public ::testing::Test {
 protected:
  GltfViewTest() { Write(kNodes); }

  void Write(const std::string& rest) {
    WriteFile(path_, absl::StrCat(R"({"asset":{"version":"2.0"},)", rest));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.Path("a.gltf");
};

TEST_F(GltfViewTest, ListsTheLightsThatAreShownUnderNamesThatDiffer) {
  const auto json = GltfLightsJson(path_);
  ASSERT_THAT(json, IsOk());
  EXPECT_THAT(*json,
              AllOf(HasSubstr(R"({"name":"lamp","position":[1.0,2.0,3.0]})"),
                    HasSubstr(R"({"name":"lamp_2","position":[4.0,5.0,6.0]})"),
                    HasSubstr(R"("name":"sky")"),
                    Not(HasSubstr("hidden"))));
}

TEST_F(GltfViewTest, ASunShinesAlongItsNodesMinusZ) {
  const auto json = GltfLightsJson(path_);
  ASSERT_THAT(json, IsOk());
  double x = 0.0, y = 0.0, z = 0.0;
  ASSERT_EQ(
      std::sscanf(json->c_str() + json->find(R"("direction":[)") + 13, "%lf,%lf,%lf", &x, &y, &z),
      3);
  // A quarter turn about x carries -z to +y.
  EXPECT_LE((Eigen::Vector3d(x, y, z) - Eigen::Vector3d::UnitY()).norm(), kTolerance);
}

TEST_F(GltfViewTest, ChoosesACameraByNameOrNumber) {
  for (const char* choice : {":front", ":0"}) {
    const auto camera = ReadGltfCamera(path_ + choice);
    ASSERT_THAT(camera, IsOk());
    EXPECT_FALSE(HasSize(*camera));
    EXPECT_EQ(FrameRatio(*camera), 2.0);
    EXPECT_EQ(camera->near, 0.5);
    EXPECT_EQ(camera->far, 9.0);
    const auto sized = SizedCamera(*camera, 200, 100);
    ASSERT_THAT(sized, IsOk());
    ASSERT_THAT(ValidateCamera(*sized), IsOk());
    // 45 degrees to each side, up and down; square pixels.
    Eigen::Matrix3d lens;
    lens << 50, 0, 100, 0, 50, 50, 0, 0, 1;
    EXPECT_THAT(sized->screen_from_camera, MatrixNear(lens, 1e-9));
    const Eigen::Vector4d seen =
        sized->ScreenFromWorld() * Eigen::Vector4d(1.0 + 1.0, 2.0 + 0.5, 3.0 - 2.0, 1.0);
    EXPECT_LE((seen.head<2>() / seen.w() - Eigen::Vector2d(125.0, 37.5)).norm(), 1e-9);
    EXPECT_THAT(SizedCamera(*camera, 200, 150),
                StatusIs(kInvalid, AllOf(HasSubstr("200x150"), HasSubstr("200x100"))));
  }
}

TEST_F(GltfViewTest, ACameraWithoutARatioFillsAnyFrame) {
  const auto camera = ReadGltfCamera(path_ + ":side: left");
  ASSERT_THAT(camera, IsOk());
  const auto sized = SizedCamera(*camera, 300, 100);
  ASSERT_THAT(sized, IsOk());
  EXPECT_EQ(sized->screen_from_camera(0, 0), sized->screen_from_camera(1, 1));
  // Looks along +x with y up: what is ahead and to its right (+z) lies right of the middle.
  const Eigen::Vector4d seen = sized->ScreenFromWorld() * Eigen::Vector4d(2.0, 0.0, 1.0, 1.0);
  EXPECT_LE((seen.head<2>() / seen.w() - Eigen::Vector2d(175.0, 50.0)).norm(), 1e-9);
}

TEST_F(GltfViewTest, ListsTheCamerasWhereNoneIsMeant) {
  EXPECT_THAT(ReadGltfCamera(path_),
              StatusIs(kInvalid,
                       AllOf(HasSubstr("has 3 cameras"),
                             HasSubstr("a.gltf:front, a.gltf:side: left, a.gltf:flat"))));
  EXPECT_THAT(ReadGltfCamera(path_ + ":frnt"),
              StatusIs(kInvalid, AllOf(HasSubstr("no camera \"frnt\""), HasSubstr("front"))));
  EXPECT_THAT(ReadGltfCamera(path_ + ":flat"), StatusIs(kInvalid, HasSubstr("orthographic")));
  EXPECT_THAT(ReadGltfCamera(folder_.Path("none.glb")),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none.glb")));
}

TEST_F(GltfViewTest, RefusesLightsAndCamerasThatAreNone) {
  const std::string light =
      R"("nodes":[{"name":"l","extensions":{"KHR_lights_punctual":{"light":0}})";
  const auto with = [&](const std::string& node, const std::string& kind) {
    Write(absl::StrCat(
        light, node, R"(}],"extensions":{"KHR_lights_punctual":{"lights":[)", kind, "]}}}"));
    return GltfLightsJson(path_);
  };
  EXPECT_THAT(with("", ""), StatusIs(kInvalid, HasSubstr("light 0 of 0")));
  EXPECT_THAT(with("", R"({"type":"dome"})"),
              StatusIs(kInvalid, AllOf(HasSubstr("\"l\""), HasSubstr("dome"))));
  EXPECT_THAT(with(R"(,"scale":[0,0,0])", R"({"type":"directional"})"),
              StatusIs(kInvalid, HasSubstr("direction")));
  Write(R"("nodes":[]})");
  EXPECT_THAT(GltfLightsJson(path_), StatusIs(kInvalid, HasSubstr("has no lights")));
  EXPECT_THAT(ReadGltfCamera(path_), StatusIs(kInvalid, HasSubstr("has no camera")));
  for (const char* lens : {R"({"yfov":0})",
                           R"({"yfov":3.2})",
                           R"({})",
                           R"({"yfov":1,"aspectRatio":-1})",
                           R"({"yfov":1,"znear":2,"zfar":1})",
                           R"({"yfov":"1"})"}) {
    Write(absl::StrCat(
        R"("nodes":[{"camera":0}],"cameras":[{"type":"perspective","perspective":)", lens, "}]}"));
    EXPECT_THAT(ReadGltfCamera(path_), StatusIs(kInvalid, HasSubstr("cameras[0]"))) << lens;
  }
  Write(
      R"("nodes":[{"camera":0,"matrix":[1,0,0,0,1,1,0,0,0,0,1,0,0,0,0,1]}],"cameras":[{"perspective":{"yfov":1}}]})");
  EXPECT_THAT(ReadGltfCamera(path_), StatusIs(kInvalid, HasSubstr("sheared")));
}

TEST_F(GltfViewTest, SaysWhatAFileHasToOffer) {
  const GltfContents contents = ContentsOf(path_);
  EXPECT_EQ(contents.num_lights, 3);
  EXPECT_THAT(contents.cameras, ElementsAre("front", "side: left", "flat"));
  EXPECT_EQ(ContentsOf(folder_.Path("none.glb")).num_lights, 0);
}

TEST(IsGltf, KnowsFilesAndFilesWithACamera) {
  for (const char* path :
       {"a.glb", "b/A.GLTF", "a.glb:front", "a.gltf:3", "c:/a.glb", "c:/a.glb:x:y"}) {
    EXPECT_TRUE(IsGltf(path)) << path;
  }
  for (const char* path : {"", "a.json", "a.glb.json", "0,1,2:3,4,5", ".glb/a.json", "aglb"}) {
    EXPECT_FALSE(IsGltf(path)) << path;
  }
}

}  // namespace
}  // namespace lightfit
