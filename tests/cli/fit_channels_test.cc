// `lightfit fit` on files of several parts, as renderers write them: what it takes and what it
// says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "tests/cli/examples.h"
#include "tests/io/exr_file.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using testing::ExrPart;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The yard, a part for every layer, positions before the depth.
class YardInParts : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto lights = ReadLightsFile(kYardLights);
    ASSERT_TRUE(lights.ok()) << lights.status();
    auto yard = ReadReadbackExr(kYard, *lights);
    ASSERT_TRUE(yard.ok()) << yard.status();
    yard_ = *std::move(yard);
    const auto depth = [this](int x, int y) { return yard_.depth[At(x, y)]; };
    const auto zero = [](int, int) { return 0.0; };
    parts_ = {
        Part("rgba", {{"R", Imf::HALF, zero}}),
        Part("P", {{"P.X", Imf::HALF, zero}, {"P.Y", Imf::HALF, zero}, {"P.Z", Imf::HALF, zero}}),
        Part("depth", {{"V", Imf::FLOAT, depth}})};
    for (const Light& light : *lights) {
      const auto shadow = [this, bit = light.shadow_bit](int x, int y) {
        return yard_.shadow_bits[At(x, y)] >> bit & 1U;
      };
      parts_.push_back(
          Part("shadow_" + light.name, {{"blue", Imf::HALF, zero}, {"red", Imf::HALF, shadow}}));
    }
  }

  size_t At(int x, int y) const { return static_cast<size_t>(y) * yard_.camera.width + x; }

  ExrPart Part(const std::string& name, std::vector<testing::Channel> channels) const {
    ExrPart part;
    part.name = name;
    part.width = part.data_width = yard_.camera.width;
    part.height = part.data_height = yard_.camera.height;
    part.channels = std::move(channels);
    return part;
  }

  ProcessResult Fit(const std::vector<ExrPart>& parts, std::vector<std::string> more) const {
    testing::WriteExr(folder_.Path("frame.exr"), parts);
    std::vector<std::string> arguments = {"fit",
                                          folder_.Path("frame.exr"),
                                          "--lights",
                                          kYardLights,
                                          "--camera",
                                          kYardLights,
                                          "--shadow-channel",
                                          "shadow_{light}.red",
                                          "--json",
                                          folder_.Path("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  TemporaryFolder folder_;
  ReadbackFile yard_;
  std::vector<ExrPart> parts_;
};

TEST_F(YardInParts, GivesTheMatricesOfTheWholeFileAndSaysWhatItTook) {
  const ProcessResult result = Fit(parts_, {});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("frame.exr (depth \"V\" of part \"depth\"): 180 x 180 pixels"));
  const v1::FitResult found = ReadResult(folder_.Path("out.json"));
  EXPECT_EQ(found.readback().origin().depth_channel(), "V");
  EXPECT_EQ(found.readback().origin().depth_part(), "depth");

  const ProcessResult whole = RunLightfit({"fit",
                                           kYard,
                                           "--lights",
                                           kYardLights,
                                           "--camera",
                                           kYardLights,
                                           "--json",
                                           folder_.Path("whole.json")});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.out, HasSubstr("0001.exr (depth \"Z\"): 180 x 180 pixels"));
  const v1::FitResult wanted = ReadResult(folder_.Path("whole.json"));
  ASSERT_EQ(found.lights_size(), wanted.lights_size());
  for (int l = 0; l < found.lights_size(); ++l) {
    EXPECT_EQ(MatrixOf(found.lights(l).map_from_world()),
              MatrixOf(wanted.lights(l).map_from_world()));
  }
}

TEST_F(YardInParts, TwoDepthsAreRefusedUntilOneIsNamed) {
  parts_.push_back(parts_[2]);
  parts_[2].name = "near.depth";
  parts_.back().name = "far.depth";
  const ProcessResult refused = Fit(parts_, {});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.out, IsEmpty());
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("\"V\" of part \"near.depth\""),
                    HasSubstr("\"V\" of part \"far.depth\""),
                    HasSubstr("PART.CHANNEL")));
  const ProcessResult named = Fit(parts_, {"--depth-channel", "near.depth.V"});
  EXPECT_EQ(named.exit_code, 0) << named.err;
}

TEST_F(YardInParts, OfAStereoFileOneViewIsTaken) {
  std::vector<ExrPart> stereo;
  for (const char* view : {"left", "right"}) {
    for (ExrPart part : parts_) {
      part.name += std::string("_") + view;
      part.view = view;
      stereo.push_back(std::move(part));
    }
  }
  const ProcessResult refused = Fit(stereo, {});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("\"left\", \"right\""), HasSubstr("view")));
  const ProcessResult left = Fit(stereo, {"--view", "left"});
  EXPECT_EQ(left.exit_code, 0) << left.err;
  EXPECT_THAT(left.out, HasSubstr("depth \"V\" of part \"depth_left\", view \"left\""));
}

TEST(FitChannels, APositionBeforeTheDepthIsNoDepth) {
  const std::string folder = RepositoryPath("../shared/cases/exr_position_part_before_depth");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no case at " << folder;
  const TemporaryFolder output;
  const auto fit = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"fit",
                                          folder + "/frame.exr",
                                          "--lights",
                                          folder + "/lights.json",
                                          "--json",
                                          output.Path("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  };
  const ProcessResult result = fit({});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("(depth \"Z\" of part \"depth\", camera of part \"depth\")"));
  const std::string found = ReadFile(output.Path("out.json"));
  EXPECT_EQ(fit({"--depth-channel", "depth.Z"}).exit_code, 0);
  EXPECT_EQ(ReadFile(output.Path("out.json")), found);
}

}  // namespace
}  // namespace lightfit
