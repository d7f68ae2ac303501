// Lights that move, from files: where they are in which frame.

#include "io/frames/light_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/lights_file.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

LightFrames Read(const std::string& json) {
  const absl::StatusOr<std::optional<LightFrames>> frames = LightFrames::Parse(json);
  EXPECT_TRUE(frames.ok() && frames->has_value()) << frames.status();
  return **frames;
}

std::vector<Light> LightsOf(const LightFrames& frames, size_t entry) {
  const absl::StatusOr<LightFrames::Frame> frame = frames.FrameOf(entry);
  EXPECT_TRUE(frame.ok()) << frame.status();
  const absl::StatusOr<std::vector<Light>> lights = ParseLightsJson(frame->json);
  EXPECT_TRUE(lights.ok()) << lights.status();
  return lights.ok() ? *lights : std::vector<Light>();
}

TEST(LightFrames, OfTheFileStandInForItsLights) {
  const LightFrames frames = Read(R"({
    "lights": [{"name": "key", "position": [1, 2, 3]}, {"name": "sun", "direction": [0, 0, -1]}],
    "frames": [{"frame": 1001, "lights": [{"name": "sun", "direction": [1, 0, -1]}]},
               {"frame": 1002, "camera_to_world": []},
               {"frame": 1003, "lights": [{"name": "rim", "position": [7, 8, 9]}]}]})");
  EXPECT_THAT(
      frames.numbers(),
      ElementsAre(FrameNumber::Whole(1001), FrameNumber::Whole(1002), FrameNumber::Whole(1003)));
  for (size_t entry = 0; entry < 3; ++entry) {
    const std::vector<Light> lights = LightsOf(frames, entry);
    ASSERT_EQ(lights.size(), 3u);
    EXPECT_EQ(lights[0].name, "key");
    EXPECT_EQ(lights[1].name, "sun");
    EXPECT_EQ(lights[1].direction.x() > 0.0, entry == 0);
    EXPECT_EQ(lights[2].name, "rim");
    EXPECT_EQ(lights[2].shadow_bit, 2);
    // It is nowhere but in the last frame.
    if (entry == 2) {
      EXPECT_THAT(frames.FrameOf(entry)->absent, IsEmpty());
    } else {
      EXPECT_THAT(frames.FrameOf(entry)->absent, ElementsAre("rim"));
    }
  }
}

TEST(LightFrames, OfALightAreTheSame) {
  const LightFrames frames = Read(R"({"lights": [
    {"name": "lamp", "frames": [{"frame": 7, "position": [1, 0, 0]},
                                {"frame": 9, "position": [2, 0, 0]}]},
    {"name": "sun", "direction": [0, 0, -1]}]})");
  ASSERT_EQ(frames.numbers().size(), 2u);
  EXPECT_EQ(LightsOf(frames, 0)[0].position.x(), 1.0);
  EXPECT_EQ(LightsOf(frames, 1)[0].position.x(), 2.0);
  EXPECT_EQ(LightsOf(frames, 1)[1].name, "sun");
}

TEST(LightFrames, FilesOfCamerasHaveLightsThatStandStill) {
  for (const char* json : {R"({"lights": [{"name": "sun", "direction": [0, 0, -1]}]})",
                           R"({"lights": [], "frames": [{"camera_to_world": []}]})",
                           R"({"frames": {"1001": {}}})",
                           R"({"lights": 3, "frames": 3})"}) {
    const absl::StatusOr<std::optional<LightFrames>> frames = LightFrames::Parse(json);
    ASSERT_TRUE(frames.ok()) << frames.status();
    EXPECT_FALSE(frames->has_value()) << json;
  }
}

TEST(LightFrames, ErrorsSayWhere) {
  const auto error = [](const std::string& json) {
    return std::string(LightFrames::Parse(json).status().message());
  };
  EXPECT_THAT(error(R"({"lights": [{"name": "a", "frames": [{"frame": 1}, {}]}]})"),
              HasSubstr("light \"a\": frames: 1 of 2"));
  EXPECT_THAT(error(R"({"lights": [{"name": "a", "frames": [{"frame": 1}]},
                                   {"name": "b", "frames": [{}]}]})"),
              HasSubstr("all or none"));
  EXPECT_THAT(error(R"({"frames": [{"lights": [{"direction": [0, 0, 1]}]}]})"),
              HasSubstr("no name"));
  // Who wants the lights of one frame is not given those of some other.
  EXPECT_THAT(ParseLightsJson(R"({"frames": [{"lights": []}]})").status().message(),
              HasSubstr("its lights move"));
}

}  // namespace
}  // namespace lightfit
