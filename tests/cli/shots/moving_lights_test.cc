// `lightfit shot` with lights that move: each frame is fitted for where its lights are.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "absl/strings/str_split.h"
#include "io/readback_exr.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/tracker.h"
#include "tests/cli/examples.h"
#include "tests/cli/shots/numbered_shot.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::NumberedShot;

constexpr MapSize kMap = {256, 256};
constexpr int kFrames = 4;

// Four frames of one camera; the lamp travels, but not from the second frame to the third, and the
// sun stands still.
class MovingLights : public ::testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < kFrames; ++i) {
      lights_.push_back(shot_.lights());
      lights_[i][1].position.x() += 1.5 * (i == 2 ? 1 : i);
      const auto view = Render(shot_.scene(), NumberedShot::CameraOf(0), lights_[i]);
      std::filesystem::create_directories(folder_.Path("in"));
      ASSERT_TRUE(WriteReadbackExr(FramePath(i), view.View(), lights_[i]).ok());
    }
    WriteFile(LightsPath(), LightsJson({0, 1, 2, 3}));
  }

  std::string FramePath(int i) const {
    return folder_.Path(absl::StrFormat("in/%d.exr", 1001 + i));
  }
  std::string LightsPath() const { return folder_.Path("lights.json"); }

  std::string LightsJson(const std::vector<int>& frames) const {
    std::vector<std::string> entries;
    for (const int i : frames) {
      const Eigen::Vector3d& p = lights_[i][1].position;
      entries.push_back(absl::StrFormat(
          R"({"frame": %d, "lights": [{"name": "lamp", "position": [%.17g, %.17g, %.17g]}]})",
          1001 + i,
          p.x(),
          p.y(),
          p.z()));
    }
    return absl::StrCat(R"({"lights": [{"name": "sun", "direction": [-0.6, 0.35, -0.72]}],
                            "frames": [)",
                        absl::StrJoin(entries, ",\n"),
                        "]}");
  }

  ProcessResult Run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"--lights", LightsPath()};
    all.insert(all.end(), more.begin(), more.end());
    return RunWithoutLights(all);
  }

  ProcessResult RunWithoutLights(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"shot",
                                          folder_.Path("in"),
                                          "--map",
                                          "256x256",
                                          "-o",
                                          folder_.Path("out"),
                                          "--quiet",
                                          "--border",
                                          "lit"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  std::string ResultPath(const std::string& mode, int frame) const {
    return folder_.Path(absl::StrFormat("out/%s/%d.json", mode, 1001 + frame));
  }
  std::string ResultText(const std::string& mode, int frame) const {
    return ReadFile(ResultPath(mode, frame));
  }
  v1::FitResult Result(const std::string& mode, int frame) const {
    return ReadResult(ResultPath(mode, frame));
  }

  const NumberedShot shot_{1};
  const TemporaryFolder folder_;
  std::vector<std::vector<Light>> lights_;  // by frame
};

TEST_F(MovingLights, EveryFrameIsFittedForItsOwn) {
  const ProcessResult result = Run({"--per-frame", "--tracked"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  Tracker tracker(TrackerOptions::ForStability(0.5));
  for (int i = 0; i < kFrames; ++i) {
    const auto file = ReadReadbackExr(FramePath(i), lights_[i]);
    ASSERT_TRUE(file.ok()) << file.status();
    const v1::FitResult per_frame = Result("per-frame", i), kept = Result("tracked", i);
    const auto tracked = tracker.Update(file->View(), lights_[i], kMap);
    for (int light = 0; light < 2; ++light) {
      const auto own = FitLight(file->View(), lights_[i][light], kMap);
      ASSERT_TRUE(own.ok() && tracked[light].ok());
      EXPECT_EQ(MatrixOf(per_frame.lights(light).map_from_world()), own->map_from_world);
      EXPECT_EQ(MatrixOf(kept.lights(light).map_from_world()),
                tracked[light]->matrix.map_from_world);
      // What moves has no crawl to speak of.
      const bool stands_still = i > 0 && (light == 0 || i == 2);
      EXPECT_EQ(per_frame.lights(light).shot().has_crawl(), stands_still) << i << " " << light;
      EXPECT_EQ(kept.lights(light).shot().has_crawl(), stands_still);
    }
    EXPECT_EQ(kept.lights(1).light().position(0), lights_[i][1].position.x());
  }
}

TEST_F(MovingLights, HeadersSayWhereTheyAre) {
  ASSERT_EQ(Run().exit_code, 3);
  std::vector<std::string> with_file;
  for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
    for (int i = 0; i < kFrames; ++i) with_file.push_back(ResultText(mode, i));
  }
  const ProcessResult result = RunWithoutLights({"--force"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("light \"lamp\": it moves (between frames 1001 and 1002)"));
  auto expected = with_file.begin();
  for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
    for (int i = 0; i < kFrames; ++i) EXPECT_EQ(ResultText(mode, i), *expected++) << mode << i;
  }
  // One frame alone likewise.
  const ProcessResult fit =
      RunLightfit({"fit", FramePath(3), "--border", "lit", "--json", folder_.Path("3.json")});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_EQ(ReadResult(folder_.Path("3.json")).lights(1).light().position(0),
            lights_[3][1].position.x());
}

TEST_F(MovingLights, AFrameWhoseHeaderLacksALightIsNamed) {
  const auto view = Render(shot_.scene(), NumberedShot::CameraOf(0), lights_[2]);
  ASSERT_TRUE(WriteReadbackExr(FramePath(2), view.View(), {lights_[2][0]}).ok());
  const ProcessResult result = RunWithoutLights({"--per-frame"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("light \"lamp\": nothing says where it is in frame 1003"));
  EXPECT_EQ(Result("per-frame", 2).lights(0).status().code(), 0);
  EXPECT_EQ(Result("per-frame", 3).lights(1).status().code(), 0);
}

TEST_F(MovingLights, OneMapForTheShotIsRefusedForThatLightAlone) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--maps", "2", "--force"}}) {
    const ProcessResult result = Run(more);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("light \"lamp\": it moves (between frames 1001 and 1002)"),
                      Not(HasSubstr("\"sun\""))));
    const v1::FitResult whole = ReadResult(folder_.Path("out/per-shot.json"));
    EXPECT_EQ(whole.lights(0).status().code(), 0);
    EXPECT_EQ(whole.lights(1).status().code(), 9);  // failed precondition
    EXPECT_EQ(Result("per-shot", 2).lights(0).status().code(), 0);
    EXPECT_EQ(Result("per-frame", 2).lights(1).status().code(), 0);
  }
}

TEST_F(MovingLights, AnotherPlaceInOneFrameIsComputedAgain) {
  ASSERT_EQ(Run({"--per-frame"}).exit_code, 0);
  const Eigen::Matrix4d before = MatrixOf(Result("per-frame", 3).lights(1).map_from_world());
  lights_[3][1].position.y() += 2.0;
  WriteFile(LightsPath(), LightsJson({0, 1, 2, 3}));
  ASSERT_EQ(Run({"--per-frame"}).exit_code, 0);
  EXPECT_NE(MatrixOf(Result("per-frame", 3).lights(1).map_from_world()), before);
}

TEST_F(MovingLights, AFrameThatTheFileLacksIsNamed) {
  WriteFile(LightsPath(), LightsJson({0, 1, 3}));
  const ProcessResult result = Run({"--per-frame"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(
      result.err,
      AllOf(HasSubstr("frame 1003"), HasSubstr("lights.json: has no lights of frame 1003")));
  EXPECT_EQ(Result("per-frame", 3).lights(1).status().code(), 0);
}

TEST_F(MovingLights, SingleReadBacksAndSummariesTakeThemByNumber) {
  const std::string json = folder_.Path("fit.json");
  ASSERT_EQ(RunLightfit({"fit", FramePath(3), "--lights", LightsPath(), "--json", json, "--quiet"})
                .exit_code,
            0);
  const v1::FitResult fit = ReadResult(json);
  EXPECT_EQ(fit.lights(1).light().position(0), lights_[3][1].position.x());
  const auto summary = [this](int i) { return folder_.Path(absl::StrCat(i, ".summary")); };
  for (const int i : {1, 2, 3}) {
    const ProcessResult result = RunLightfit(
        {"summarize", FramePath(i), "--lights", LightsPath(), "-o", summary(i), "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  // Where the lamp stands still the frames add up.
  EXPECT_EQ(RunLightfit({"fit", "--summary", summary(1), summary(2), "--quiet"}).exit_code, 0);
  const ProcessResult moved = RunLightfit({"fit", "--summary", summary(1), summary(3), "--quiet"});
  EXPECT_EQ(moved.exit_code, 2);
  EXPECT_THAT(moved.err,
              AllOf(HasSubstr("\"lamp\" with position"), HasSubstr("A light that moves")));
  // Its frames cannot serve a scene that is told no frame.
  const ProcessResult other =
      RunLightfit({"compare", "generate", "--camera", "0,2,11:0,1,0", "--lights", LightsPath()});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("its lights move"));
}

}  // namespace
}  // namespace lightfit
