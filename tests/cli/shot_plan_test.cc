// `lightfit shot --maps`: plans of several maps over a shot.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "tests/cli/box_shot.h"
#include "tests/testing/matchers.h"
#include "wire/plan_proto.h"
#include "wire/result_json.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;

constexpr int64_t kTexels = 40000;

ProcessResult RunWithMaps(const BoxShot& shot, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"shot",
                                        shot.Path("walk"),
                                        "--lights",
                                        shot.LightsPath(),
                                        "--maps",
                                        "3",
                                        "--texels",
                                        "200x200",
                                        "-o",
                                        shot.Output()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunLightfit(arguments);
}

v1::FitResult ReadResult(const std::string& path) {
  const absl::StatusOr<v1::FitResult> result = ReadFitResultJson(path);
  EXPECT_THAT(result, IsOk()) << path;
  return result.value_or(v1::FitResult());
}

TEST(ShotPlan, EveryFrameHasAPlanInEveryMode) {
  const BoxShot shot(5);
  const ProcessResult run = RunWithMaps(shot);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("up to 3 maps for each light, 40000 texels in all"));
  EXPECT_THAT(run.out, HasSubstr("moved / all"));
  const v1::FitResult whole = ReadResult(shot.Output() + "/per-shot.json");
  ASSERT_EQ(whole.lights_size(), 2);
  int num_several = 0;
  for (int frame = 0; frame < shot.num_frames(); ++frame) {
    for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
      const v1::FitResult result = ReadResult(shot.ResultPath(mode, frame));
      SCOPED_TRACE(::testing::Message() << mode << ", frame " << frame);
      EXPECT_EQ(result.plan_options().max_maps(), 3);
      ASSERT_EQ(result.lights_size(), 2);
      for (int light = 0; light < 2; ++light) {
        const v1::LightResult& of = result.lights(light);
        ASSERT_EQ(of.status().code(), 0) << of.status().message();
        const absl::StatusOr<Plan> plan = PlanFromProto(of.plan(), "plan");
        ASSERT_THAT(plan, IsOk());
        EXPECT_LE(NumTexels(*plan), kTexels);
        EXPECT_GT(of.energies().final(), 0.0);
        num_several += plan->maps.size() > 1 ? 1 : 0;
        if (std::string(mode) == "tracked") {
          EXPECT_EQ(of.shot().plan().maps_size(), static_cast<int>(plan->maps.size()));
          EXPECT_EQ(of.shot().plan().is_new() || frame > 0, true);
        }
        if (std::string(mode) != "per-shot") continue;
        const absl::StatusOr<Plan> for_all = PlanFromProto(whole.lights(light).plan(), "plan");
        ASSERT_THAT(for_all, IsOk());
        ASSERT_EQ(plan->maps.size(), for_all->maps.size());
        for (size_t k = 0; k < plan->maps.size(); ++k) {
          EXPECT_EQ(plan->maps[k].map_from_world, for_all->maps[k].map_from_world);
        }
        // Nothing moves, so nothing crawls.
        EXPECT_EQ(of.shot().crawl().phase_drift_texels(), 0.0);
      }
    }
  }
  EXPECT_GT(num_several, 15);
  EXPECT_FALSE(std::filesystem::exists(shot.Output() + "/summaries"));
}

TEST(ShotPlan, GoesOnInTheSameBytesWhateverTheThreads) {
  const BoxShot shot(5);
  ASSERT_EQ(RunWithMaps(shot, {"--quiet", "--threads", "1"}).exit_code, 0);
  const auto whole = FilesBelow(shot.Output());
  constexpr uint32_t kSeed = 11;
  std::mt19937 random(kSeed);
  for (int round = 0; round < 2; ++round) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", round " << round);
    for (const auto& [name, text] : whole) {
      if (random() % 3 == 0) std::filesystem::remove(shot.Output() + "/" + name);
    }
    ASSERT_EQ(RunWithMaps(shot, {"--quiet", "--threads", "3"}).exit_code, 0);
    EXPECT_TRUE(whole == FilesBelow(shot.Output()));
  }
}

TEST(ShotPlan, MapsOfOneSizeHaveThatSize) {
  const BoxShot shot(2);
  const ProcessResult run = shot.Run({"--maps", "2", "--per-frame"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("up to 2 maps for each light, 300 x 200 texels each"));
  const v1::FitResult result = ReadResult(shot.ResultPath("per-frame", 0));
  for (const v1::LightResult& light : result.lights()) {
    for (const v1::PlanMap& map : light.plan().maps()) {
      EXPECT_EQ(map.map().width(), 300);
      EXPECT_EQ(map.map().height(), 200);
    }
  }
}

TEST(ShotPlan, SaysWhatDoesNotGoWithPlans) {
  const BoxShot shot(1);
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--as-published"},
                                               {"--replace-below", "0.5"},
                                               {"--rounds", "1"},
                                               {"--search", "focused"}}) {
    const ProcessResult run = RunWithMaps(shot, more);
    EXPECT_EQ(run.exit_code, 1) << more[0];
    EXPECT_THAT(run.err, HasSubstr(more[0]));
  }
}

}  // namespace
}  // namespace lightfit
