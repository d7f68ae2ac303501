// `lightfit compare --crawl` from end to end: how the next frame is told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "lightfit/v1/comparison.pb.h"
#include "tests/cli/examples.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using ::testing::Not;
using testing::RelativeError;

// The program on a scene and on a read-back.
constexpr char kYardSun[] = "sun=sun:-0.93357,-0.23733,-0.26855";

class CompareNextTest : public ::testing::Test {
 protected:
  CompareNextTest() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  ProcessResult OnScene(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"compare",
                                          folder_.Path("scene.obj"),
                                          "--camera",
                                          kBoxesCamera,
                                          "--screen",
                                          "160x120",
                                          "--readback",
                                          "96x72",
                                          "--map",
                                          "100x100",
                                          "--light",
                                          "sun=sun:-1,-1.3,0.4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  ProcessResult OnReadback(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"compare", kYard, "--light", kYardSun};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  v1::Comparison ReadComparison() const {
    v1::Comparison comparison;
    const absl::Status status = JsonToProto(ReadFile(folder_.Path("out.json")), comparison);
    EXPECT_THAT(status, IsOk());
    return comparison;
  }

  const TemporaryFolder folder_;
};

TEST_F(CompareNextTest, ASceneGivesDriftAndFlips) {
  const ProcessResult result = OnScene({"--crawl",
                                        "--json",
                                        folder_.Path("out.json"),
                                        "--csv",
                                        folder_.Path("out.csv"),
                                        "--legend"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("crawl: to the next frame, the camera moves 0."),
                    HasSubstr("0.5 deg to the right"),
                    HasSubstr("% flips"),
                    HasSubstr("Crawl, to the next frame")));
  const v1::Comparison comparison = ReadComparison();
  EXPECT_TRUE(comparison.has_next_camera());
  for (const v1::MethodComparison& method : comparison.lights(0).methods()) {
    SCOPED_TRACE(method.method());
    ASSERT_TRUE(method.has_crawl()) << method.note();
    EXPECT_GT(method.crawl().num_points(), 500);
    EXPECT_GT(method.crawl().flicker().judged(), 5000);
    EXPECT_LE(method.crawl().phase_drift_texels(), 0.5 * std::sqrt(2.0));
  }
  // What does not look at the view has the same matrix in both frames.
  const v1::MethodComparison& standard = comparison.lights(0).methods(0);
  EXPECT_EQ(standard.method(), "standard");
  EXPECT_EQ(standard.crawl().phase_drift_texels(), 0.0);
  EXPECT_EQ(standard.crawl().flicker().flips_practical(), 0);
  ASSERT_TRUE(comparison.totals(9).has_crawl());
  EXPECT_EQ(comparison.totals(9).num_crawl_lights(), 1);
  EXPECT_THAT(ReadFile(folder_.Path("out.csv")), HasSubstr("crawl_texels,crawl_moved_share"));
}

TEST_F(CompareNextTest, NoCrawlIsReportedUnlessAskedFor) {
  const ProcessResult result = OnScene({"--json", folder_.Path("out.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(Not(HasSubstr("crawl")), Not(HasSubstr("flips"))));
  EXPECT_THAT(ReadFile(folder_.Path("out.json")), Not(HasSubstr("crawl")));
}

TEST_F(CompareNextTest, AStepIsTakenAsSaid) {
  const ProcessResult still = OnScene({"--camera-step", "0,0,0"});
  EXPECT_EQ(still.exit_code, 0) << still.err;
  EXPECT_THAT(still.out, HasSubstr("the camera moves none"));
  const ProcessResult far = OnScene({"--camera-step", "0,0,0,180"});
  EXPECT_THAT(far.err,
              AnyOf(HasSubstr("no surface is seen in both frames"),
                    HasSubstr("next frame: camera: sees no")));
}

TEST_F(CompareNextTest, FramesOfACameraFileFollowEachOther) {
  // The second camera stands one unit nearer.
  const auto frame = [](double z) {
    return absl::StrCat("{\"camera_to_world\": [1,0,0,0, 0,1,0,2, 0,0,1,",
                        z,
                        ", 0,0,0,1], \"projection\": [1.3,0,0,0, 0,1.7333333,0,0, "
                        "0,0,-1.002,-0.2, 0,0,-1,0]}");
  };
  WriteFile(
      folder_.Path("cameras.json"),
      absl::StrCat(
          "{\"width\": 160, \"height\": 120, \"frames\": [", frame(11), ",", frame(10), "]}"));
  const std::vector<std::string> arguments = {"compare",
                                              folder_.Path("scene.obj"),
                                              "--camera",
                                              folder_.Path("cameras.json"),
                                              "--screen",
                                              "160x120",
                                              "--map",
                                              "100x100",
                                              "--light",
                                              "sun=sun:-1,-1.3,0.4"};
  const auto with = [&arguments](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return RunLightfit(more);
  };
  const std::string json = folder_.Path("out.json");
  const ProcessResult frames = with({"--next-frame", "1", "--json", json});
  EXPECT_EQ(frames.exit_code, 0) << frames.err;
  EXPECT_THAT(frames.out, HasSubstr("frame 1 of "));
  const v1::Comparison by_frame = ReadComparison();
  const ProcessResult step = with({"--camera-step", "1,0,0", "--json", json});
  EXPECT_EQ(step.exit_code, 0) << step.err;
  const v1::Comparison by_step = ReadComparison();
  for (int row = 0; row < by_step.lights(0).methods_size(); ++row) {
    const v1::Crawl& a = by_frame.lights(0).methods(row).crawl();
    const v1::Crawl& b = by_step.lights(0).methods(row).crawl();
    EXPECT_EQ(a.num_points(), b.num_points());
    EXPECT_LE(RelativeError(a.phase_drift_texels(), b.phase_drift_texels()), 1e-3);
  }
}

TEST_F(CompareNextTest, AReadbackWantsItsNextFrame) {
  const ProcessResult same =
      OnReadback({"--next-readback", kYard, "--json", folder_.Path("out.json")});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, AllOf(HasSubstr("crawl"), Not(HasSubstr("flips"))));
  const v1::Comparison comparison = ReadComparison();
  for (const v1::MethodComparison& method : comparison.lights(0).methods()) {
    SCOPED_TRACE(method.method());
    ASSERT_TRUE(method.has_crawl()) << method.note();
    EXPECT_FALSE(method.crawl().has_flicker());
    EXPECT_GT(method.crawl().num_points(), 1000);
    EXPECT_EQ(method.crawl().phase_drift_texels(), 0.0);
  }
}

TEST_F(CompareNextTest, WrongUsageSaysTheWayOut) {
  const auto expect_error = [](const ProcessResult& result, int code, const std::string& words) {
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_THAT(result.out, IsEmpty());
  };
  expect_error(OnScene({"--camera-step", "1,2"}), 1, "FORWARD,RIGHT,UP");
  expect_error(OnScene({"--camera-step", "0,0,0", "--next-frame", "1"}), 1, "--camera-step");
  expect_error(OnScene({"--next-frame", "-1"}), 1, "--next-frame");
  expect_error(OnScene({"--next-frame", "1"}), 2, "want --camera FILE with frames");
  expect_error(OnScene({"--next-readback", kYard}), 2, "want --camera-step or --next-frame");
  expect_error(OnReadback({"--crawl"}), 2, "--next-readback FILE.exr");
  expect_error(OnReadback({"--camera-step", "0,0,0"}), 2, "--next-readback FILE.exr");
  expect_error(OnReadback({"--next-readback", "/no/0002.exr"}), 2, "next frame: /no/0002.exr");
}

}  // namespace
}  // namespace lightfit
