// `lightfit compare --masks`: the wrong pixels of every method as images.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "io/readback_exr.h"
#include "tests/cli/examples.h"
#include "tests/cli/exr_pixels.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CompareMasks : public ::testing::Test {
 protected:
  CompareMasks() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  ProcessResult Compare(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"compare",
                                          folder_.Path("scene.obj"),
                                          "--camera",
                                          kBoxesCamera,
                                          "--screen",
                                          "120x90",
                                          "--map",
                                          "64x64",
                                          "--masks",
                                          folder_.Path("masks/of boxes"),
                                          "--csv",
                                          folder_.Path("out.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  ExrPixels Masks(const std::string& name) const {
    return ReadExrPixels(folder_.Path("masks/of boxes/" + name));
  }

  // Wrong pixels by method, with ideal and with practical bias; of the first light.
  std::map<std::string, std::pair<int, int>> Counts() const {
    std::map<std::string, std::pair<int, int>> counts;
    for (const absl::string_view line :
         absl::StrSplit(ReadFile(folder_.Path("out.csv")), '\n', absl::SkipEmpty())) {
      const std::vector<std::string> cells = absl::StrSplit(line, ',');
      int ideal = 0, practical = 0;
      if (!absl::SimpleAtoi(cells[7], &ideal) || !absl::SimpleAtoi(cells[8], &practical)) continue;
      counts.emplace(cells[5], std::pair(ideal, practical));
    }
    return counts;
  }

  const TemporaryFolder folder_;
};

// In a single phase their sums are the counts of the table, method by method.
TEST_F(CompareMasks, HaveAsManyPixelsAsTheTableCounts) {
  const ProcessResult result = Compare({"--light", "sun=sun:-1,-1.3,0.4", "--phases", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ExrPixels masks = Masks("sun.exr");
  EXPECT_EQ(masks.width, 120);
  EXPECT_EQ(masks.height, 90);
  const auto counts = Counts();
  ASSERT_EQ(counts.size(), 10U);
  EXPECT_EQ(masks.channels.size(), 2 * counts.size() + 2);
  for (const auto& [method, wrong] : counts) {
    EXPECT_EQ(masks.Sum(method + ".ideal"), wrong.first) << method;
    EXPECT_EQ(masks.Sum(method + ".practical"), wrong.second) << method;
    EXPECT_GT(wrong.first, 0) << method;
  }
  const std::vector<float>& facing = masks.channels.at("truth.facing");
  const std::vector<float>& shadow = masks.channels.at("truth.shadow");
  for (const auto& [name, values] : masks.channels) {
    for (size_t i = 0; i < values.size(); ++i) {
      ASSERT_TRUE(values[i] == 0.0F || values[i] == 1.0F) << name;
      ASSERT_LE(values[i], facing[i]) << name;  // nothing is wrong, or in shadow, that faces away
    }
  }
  EXPECT_GT(masks.Sum("truth.shadow"), 0.0);
  EXPECT_LT(masks.Sum("truth.shadow"), masks.Sum("truth.facing"));
  ASSERT_EQ(shadow.size(), 120U * 90U);
}

// The shadows and the camera are those that `render` makes of the same view.
TEST_F(CompareMasks, HaveTheTruthAndTheCameraOfARender) {
  ASSERT_EQ(Compare({"--light", "lamp.key=point:4,9,6"}).exit_code, 0);
  const ProcessResult render = RunLightfit({"render",
                                            folder_.Path("scene.obj"),
                                            "--camera",
                                            kBoxesCamera,
                                            "--light",
                                            "lamp.key=point:4,9,6",
                                            "--size",
                                            "120x90",
                                            "-o",
                                            folder_.Path("frame.exr")});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  const ExrPixels masks = Masks("lamp.key.exr"), frame = ReadExrPixels(folder_.Path("frame.exr"));
  EXPECT_EQ(masks.channels.at("truth.shadow"), frame.channels.at("shadow.lamp.key"));
  EXPECT_EQ(masks.channels.at("truth.facing"), frame.channels.at("facing.lamp.key"));
  const Light lamp = Light::Point("lamp.key", {4, 9, 6}, 0);
  ReadbackExrOptions as_depth;
  as_depth.depth_channel = "truth.shadow";
  as_depth.shadow_channels = {{"lamp.key", "truth.facing"}};
  const auto of_masks =
      ReadReadbackExr(folder_.Path("masks/of boxes/lamp.key.exr"), {lamp}, as_depth);
  const auto of_frame = ReadReadbackExr(folder_.Path("frame.exr"), {lamp});
  ASSERT_TRUE(of_masks.ok()) << of_masks.status();
  ASSERT_TRUE(of_frame.ok()) << of_frame.status();
  EXPECT_EQ(of_masks->camera.camera_from_world, of_frame->camera.camera_from_world);
  EXPECT_EQ(of_masks->camera.screen_from_camera, of_frame->camera.screen_from_camera);
}

// Names of lights become names of files, each its own; spaces in those of methods become "_".
TEST_F(CompareMasks, AreAFileForEachLightWhateverItsName) {
  const ProcessResult result = Compare({"--light",
                                        "../key/1=sun:-1,-1.3,0.4",
                                        "--light",
                                        ".._key_1=sun:-1,-1.4,0.4",
                                        "--maps",
                                        "2",
                                        "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(folder_.Files(), ElementsAre("masks", "out.csv", "scene.obj"));
  const ExrPixels first = Masks("_.._key_1.exr"), second = Masks("_.._key_1_2.exr");
  EXPECT_EQ(first.channels.count("one_map.ideal"), 1U);
  EXPECT_EQ(first.channels.count("lightfit.practical"), 1U);
  EXPECT_NE(first.channels.at("truth.shadow"), second.channels.at("truth.shadow"));
}

TEST_F(CompareMasks, NeedTruth) {
  const ProcessResult result =
      RunLightfit({"compare", kYard, "--lights", kYardLights, "--masks", folder_.Path("none")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--masks"));
  EXPECT_THAT(result.err, HasSubstr("lightfit fit --footprint FILE.exr"));
  EXPECT_THAT(folder_.Files(), ElementsAre("scene.obj"));
}

TEST_F(CompareMasks, NeedAFolder) {
  WriteFile(folder_.Path("masks"), "a file");
  const ProcessResult result = Compare({"--light", "sun=sun:-1,-1.3,0.4"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("the folder cannot be made"));
}

}  // namespace
}  // namespace lightfit
