// `lightfit fit` end to end on rendered read-backs: what it prints, draws and returns.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::map<std::string, v1::LightResult> ByName(const v1::FitResult& result) {
  std::map<std::string, v1::LightResult> lights;
  for (const v1::LightResult& light : result.lights()) lights[light.name()] = light;
  return lights;
}

// Width and height in the header of a PNG file.
std::pair<uint32_t, uint32_t> PngSize(const std::string& path) {
  const std::string bytes = ReadFile(path);
  if (bytes.size() < 24 || bytes.compare(1, 3, "PNG") != 0) {
    ADD_FAILURE() << path << " is no PNG file";
    return {0, 0};
  }
  const auto word = [&bytes](size_t at) {
    uint32_t value = 0;
    for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[i]);
    return value;
  };
  return {word(16), word(20)};
}

TEST(Fit, PrintsEveryLightWithItsFigures) {
  const ProcessResult result = RunLightfit({"fit", kYard, "--lights", kYardLights});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* words : {"180 x 180 pixels",
                            "1024 x 1024 texels",
                            "focused",
                            "published",
                            "final",
                            "depth edge",
                            "facing away",
                            "edge-on",
                            "background",
                            "footprint, px",
                            "\n\nColumns: lightfit fit --help, or --legend here.\n"}) {
    EXPECT_THAT(result.out, HasSubstr(words));
  }
  int num_sun_rows = 0;
  for (const absl::string_view line : absl::StrSplit(result.out, '\n')) {
    num_sun_rows += absl::StartsWith(line, "sun ") ? 1 : 0;
    EXPECT_FALSE(absl::EndsWith(line, " ")) << line;
    const bool has_path = absl::StartsWith(line, kYard);
    EXPECT_TRUE(has_path || line.size() <= 110) << line;
  }
  EXPECT_EQ(num_sun_rows, 2) << result.out;
}

TEST(Fit, SameInputGivesTheSameBytes) {
  std::string json[2], picture[2];
  for (int i = 0; i < 2; ++i) {
    const TemporaryFolder folder;
    const ProcessResult result = RunLightfit({"fit",
                                              kYard,
                                              "--lights",
                                              kYardLights,
                                              "--json",
                                              folder.Path("out.json"),
                                              "--picture",
                                              folder.Path("out.png")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    json[i] = ReadFile(folder.Path("out.json"));
    picture[i] = ReadFile(folder.Path("out.png"));
    EXPECT_THAT(folder.Files(), ElementsAre("out.json", "out.png"));
  }
  EXPECT_FALSE(json[0].empty());
  EXPECT_EQ(json[0], json[1]);
  EXPECT_FALSE(picture[0].empty());
  EXPECT_TRUE(picture[0] == picture[1]);
}

TEST(Fit, PictureHasOneRowPerLight) {
  const TemporaryFolder folder;
  uint32_t heights[2];
  const std::vector<std::string> only[] = {{"--only", "sun"}, {"--only", "sun", "--only", "rim"}};
  for (int i = 0; i < 2; ++i) {
    const std::string path = folder.Path(absl::StrCat(i, ".png"));
    std::vector<std::string> arguments = {"fit", kYard, "--lights", kYardLights, "--picture", path};
    arguments.insert(arguments.end(), only[i].begin(), only[i].end());
    ASSERT_EQ(RunLightfit(arguments).exit_code, 0);
    const auto [width, height] = PngSize(path);
    // Four panels of 540 pixels and what lies between them.
    EXPECT_GT(width, 4u * 540);
    EXPECT_LT(width, 4u * 540 + 400);
    heights[i] = height;
  }
  EXPECT_GT(heights[1], heights[0] + 540);
  EXPECT_LT(heights[1], heights[0] + 740);
}

TEST(Fit, OnlyKeepsTheNamedLights) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  ASSERT_EQ(
      RunLightfit(
          {"fit", kYard, "--lights", kYardLights, "--only", "rim", "--only", "sun", "--json", json})
          .exit_code,
      0);
  std::vector<std::string> names;
  const v1::FitResult fit = ReadResult(json);
  for (const v1::LightResult& light : fit.lights()) names.push_back(light.name());
  EXPECT_THAT(names, ElementsAre("sun", "rim"));
}

TEST(Fit, QuietPrintsNothingWhenAllIsWell) {
  const ProcessResult result = RunLightfit({"fit", kYard, "--lights", kYardLights, "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, IsEmpty());
}

// The key light hangs among its receivers: no single map exists for it.
TEST(Fit, ALightAmongItsReceiversIsNamedAndTheOthersAreWritten) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json"), picture = folder.Path("out.png");
  const ProcessResult result = RunLightfit({"fit",
                                            kRoom,
                                            "--lights",
                                            kRoomLights,
                                            "--cover",
                                            "receivers",
                                            "--json",
                                            json,
                                            "--picture",
                                            picture});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("no matrix for light \"key\""));
  EXPECT_THAT(result.err, Not(HasSubstr("\"sun\"")));
  EXPECT_THAT(result.out, HasSubstr("no matrix"));
  std::map<std::string, v1::LightResult> lights = ByName(ReadResult(json));
  ASSERT_EQ(lights.size(), 3u);
  EXPECT_EQ(lights["sun"].status().code(), 0);
  EXPECT_EQ(lights["rim"].status().code(), 0);
  EXPECT_EQ(lights["key"].status().code(), static_cast<int>(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(lights["key"].status().message(), HasSubstr("key"));
  EXPECT_FALSE(lights["key"].has_map_from_world());
  EXPECT_TRUE(lights["rim"].has_map_from_world());
  EXPECT_GT(PngSize(picture).first, 0u);
}

// What that light shadows lies on one side of it: a map of that is there, a focused one is not.
TEST(Fit, ALightAmongItsReceiversHasAMapOfItsShadows) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json"), picture = folder.Path("out.png");
  const ProcessResult result =
      RunLightfit({"fit", kRoom, "--lights", kRoomLights, "--json", json, "--picture", picture});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::map<std::string, v1::LightResult> lights = ByName(ReadResult(json));
  EXPECT_TRUE(lights["key"].has_map_from_world());
  EXPECT_FALSE(lights["key"].energies().has_focused());
  EXPECT_GT(lights["key"].foretold_wrong().final(), 0.0);
  EXPECT_GT(PngSize(picture).first, 0u);
}

TEST(Fit, ALightWithoutAShadowChannelFailsAlone) {
  const ProcessResult result = RunLightfit(
      {"fit", kYard, "--lights", kYardLights, "--light", "lamp=point:1,2,3", "--quiet"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("light \"lamp\""));
  EXPECT_THAT(result.err, HasSubstr("shadow.lamp"));
  EXPECT_THAT(result.err, Not(HasSubstr("light \"sun\"")));
}

TEST(Fit, FullHdReadBack) {
  const std::string folder = RepositoryPath("../shared/readbacks/room_1080p");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no read-backs at " << folder;
  const TemporaryFolder output;
  const std::string picture = output.Path("out.png");
  const ProcessResult result = RunLightfit({"fit",
                                            folder + "/0001.exr",
                                            "--lights",
                                            folder + "/scene.json",
                                            "--map",
                                            "2048x2048",
                                            "--picture",
                                            picture});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1920 x 1080 pixels"));
  EXPECT_LT(PngSize(picture).first, 2600u);
}

}  // namespace
}  // namespace lightfit
