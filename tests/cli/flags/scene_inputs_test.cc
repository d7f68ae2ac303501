#include "cli/flags/scene_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "cli/flags/scene_flags.h"
#include "tests/scenes/glb_bytes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

TEST(SceneLights, NumbersGivenAndRandomLightsInOneRow) {
  SceneFlags flags;
  EXPECT_THAT(SceneLights(flags), StatusIs(kInvalid, HasSubstr("--random-lights")));
  flags.lights.extra = {Light::Point("key", {1, 2, 3}), Light::Directional("sky", {0, -1, 0})};
  flags.num_random_lights = 40;
  const auto lights = SceneLights(flags);
  ASSERT_THAT(lights, IsOk());
  ASSERT_EQ(lights->size(), 42u);
  EXPECT_EQ((*lights)[2].name, "sun001");
  for (int i = 0; i < 42; ++i) EXPECT_EQ((*lights)[i].shadow_bit, i % kMaxLights);
  flags.lights.extra[0].name = "sun007";
  EXPECT_THAT(SceneLights(flags), StatusIs(kInvalid, HasSubstr("sun007")));
}

TEST(MakeViewCamera, NamesWhatIsWrongWithTheView) {
  SceneFlags flags;
  EXPECT_THAT(MakeViewCamera(flags, 10, 10), StatusIs(kInvalid, HasSubstr("no camera")));
  flags.camera = "view";
  flags.view = ViewFlags{{1, 2, 3}, {1, 2, 3}, 60.0};
  EXPECT_THAT(MakeViewCamera(flags, 10, 10), StatusIs(kInvalid, HasSubstr("both (1, 2, 3)")));
  flags.view->target = {1, 9, 3};
  EXPECT_THAT(MakeViewCamera(flags, 10, 10), StatusIs(kInvalid, HasSubstr("--up 0,0,1")));
  flags.up = Eigen::Vector3d::UnitX();
  EXPECT_THAT(MakeViewCamera(flags, 10, 10), IsOk());
}

// "WIDTHxHEIGHT" where the image is to be 750 pixels high.
std::string DefaultSizeText(const SceneFlags& flags) {
  const PixelSize size = DefaultImageSize(flags, 750);
  return absl::StrCat(size.width, "x", size.height);
}

TEST(DefaultImageSize, IsAsWideAsTheFileOfTheCameraSays) {
  const TemporaryFolder folder;
  const auto write = [&folder](const std::string& name, const std::string& bytes) {
    WriteFile(folder.Path(name), bytes);
    return folder.Path(name);
  };
  const auto glb = [](const std::string& aspect) {
    return testing::GlbOf(
        R"({"asset": {"version": "2.0"}, "nodes": [{"camera": 0}], "scenes": [{"nodes": [0]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1)" +
            aspect + "}}]}",
        "");
  };
  SceneFlags flags;
  flags.scene = write("wide.glb", glb(R"(, "aspectRatio": 2.39)"));
  EXPECT_EQ(DefaultSizeText(flags), "1793x750");  // 1792.5
  flags.scene = write("any.glb", glb(""));
  EXPECT_EQ(DefaultSizeText(flags), "750x750");
  flags.scene = write("banner.glb", glb(R"(, "aspectRatio": 100)"));
  EXPECT_EQ(DefaultSizeText(flags), "8192x750");

  const std::string pose = R"({"camera_to_world": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],
      "projection": [1.8,0,0,0, 0,3.2,0,0, 0,0,-1,-0.2, 0,0,-1,0]})";
  flags.camera = write("scene.json",
                       absl::StrCat(R"({"width": 1920, "height": 1080, "frames": [)", pose, "]}"));
  EXPECT_EQ(DefaultSizeText(flags), "1333x750");
  ASSERT_THAT(MakeViewCamera(flags, 1333, 750), IsOk());
  flags.frame = FrameNumber::Whole(7);  // there is none: said where the camera is read
  EXPECT_EQ(DefaultSizeText(flags), "750x750");
  flags.camera = folder.Path("none.json");
  EXPECT_EQ(DefaultSizeText(flags), "750x750");
  flags.view = ViewFlags{{1, 2, 3}, {0, 0, 0}, 60.0};
  EXPECT_EQ(DefaultSizeText(flags), "750x750");
}

}  // namespace
}  // namespace lightfit::cli
