// `lightfit allocate` end to end on summaries, of one frame and of a shot.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/evaluate.h"
#include "optimizer/figures/figures.h"
#include "tests/cli/allocations.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

ProcessResult AllocateSummary(const std::string& path, const Arguments& more) {
  return RunLightfit(Joined({"allocate", "--summary", path}, more));
}

// "name: width x height" of every light, in order of the names.
Arguments SizesOf(const v1::Allocation& allocation) {
  Arguments sizes;
  for (const v1::LightResult& light : allocation.lights()) {
    sizes.push_back(
        absl::StrFormat("%s: %d x %d", light.name(), light.map().width(), light.map().height()));
  }
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

// With squares the sums tell what the samples do: budgets and tolerances come to the same sizes.
TEST(AllocateSummary, OneFrameInSquaresGivesTheSizesOfItsReadBack) {
  const TemporaryFolder folder;
  const std::string summary = YardSummary(folder, "yard.summary", {"--metric", "l2"});
  const std::string direct = folder.Path("direct.json"), summed = folder.Path("summed.json");
  const std::pair<Arguments, Arguments> goals[] = {
      {{"--budget", "2048x2048"}, {"--metric", "l2"}},
      {{"--budget", "1500000", "--power-of-two", "--weight", "sun=3"}, {"--metric", "l2"}},
      {{"--tolerance", "rms:1.0"}, {}}};
  for (const auto& [goal, metric] : goals) {
    SCOPED_TRACE(goal[1]);
    const ProcessResult result =
        AllocateSummary(summary, Joined(goal, {"--json", summed, "--legend"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_THAT(result.out,
                AllOf(HasSubstr("yard.summary: 1 frame\n"),
                      HasSubstr("wrong pixels need a read-back"),
                      HasSubstr(" rms "),
                      Not(HasSubstr("99 %")),
                      Not(HasSubstr("of image"))));
    ASSERT_EQ(AllocateYard(Joined(Joined(goal, metric), {"--json", direct, "--quiet"})).exit_code,
              0);
    const v1::Allocation expected = ReadAllocation(direct), allocation = ReadAllocation(summed);
    EXPECT_EQ(SizesOf(allocation), SizesOf(expected));
    EXPECT_EQ(allocation.texels(), expected.texels());
    EXPECT_EQ(allocation.readback().source(), summary);
    EXPECT_FALSE(allocation.readback().has_camera());
    ASSERT_EQ(allocation.maps_size(), 3);
    for (int i = 0; i < 3; ++i) {
      const v1::LightResult& light = allocation.lights(i);
      EXPECT_TRUE(MatrixOf(light.map_from_world()).allFinite());
      EXPECT_GT(light.footprint().rms(), 0.0);
      EXPECT_FALSE(light.footprint().has_p99());
      EXPECT_FALSE(light.has_foretold_wrong());
      EXPECT_EQ(allocation.maps(i).has_equal_split_energy(), expected.has_budget_texels());
    }
  }
}

// The l1 metrics weigh samples by a map, and summarize by a square one: the sizes are not quite the
// read-back's, which tries other aspects too. Weighed anew by the maps found, they come closer.
TEST(AllocateSummary, OneFrameInFootprintsComesCloseAndCloserWeighedAnew) {
  constexpr double kWorseOnce = 1.02, kWorseTwice = 1.005;  // in energy; found: 1.010 and 1.0018
  const TemporaryFolder folder;
  const std::string direct = folder.Path("direct.json"), summed = folder.Path("summed.json");
  const Arguments budget = {"--budget", "2048x2048", "--quiet", "--json"};
  ASSERT_EQ(AllocateYard(Joined(budget, {direct})).exit_code, 0);
  const v1::Allocation expected = ReadAllocation(direct);
  const auto energy = [](const v1::Allocation& allocation) {
    double sum = 0.0;
    for (const v1::LightResult& light : allocation.lights()) sum += light.energies().final();
    return sum;
  };
  const std::string first = YardSummary(folder, "first.summary");
  ASSERT_EQ(AllocateSummary(first, Joined(budget, {summed})).exit_code, 0);
  const v1::Allocation once = ReadAllocation(summed);
  EXPECT_LE(once.texels(), once.budget_texels());
  EXPECT_FALSE(once.lights(0).has_footprint());
  EXPECT_LT(energy(once), kWorseOnce * energy(expected));
  const std::string second = YardSummary(folder, "second.summary", {"--weigh-by", summed});
  ASSERT_EQ(AllocateSummary(second, Joined(budget, {summed})).exit_code, 0);
  const v1::Allocation twice = ReadAllocation(summed);
  EXPECT_LE(twice.texels(), twice.budget_texels());
  EXPECT_LT(energy(twice), kWorseTwice * energy(expected));
  EXPECT_LT(energy(twice), energy(once));
}

TEST(AllocateSummary, FilesMayBeNamedInAnyOrderAndLightsLeftOut) {
  const TemporaryFolder folder;
  const std::string a = YardSummary(folder, "a.summary"), b = folder.Path("b.summary");
  ASSERT_EQ(RunLightfit({"summarize", a, a, "-o", b}).exit_code, 0);
  const std::string path = folder.Path("maps.json");
  std::string json[2];
  for (int i = 0; i < 2; ++i) {
    const ProcessResult result = RunLightfit({"allocate",
                                              "--summary",
                                              i == 0 ? a : b,
                                              i == 0 ? b : a,
                                              "--only",
                                              "sun",
                                              "--only",
                                              "rim",
                                              "--budget",
                                              "1024x1024",
                                              "--json",
                                              path});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out,
                AllOf(HasSubstr("2 summaries: 3 frames\n"), Not(HasSubstr("footprint, pixels"))));
    json[i] = ReadFile(path);
  }
  EXPECT_FALSE(json[0].empty());
  EXPECT_EQ(json[0], json[1]);
  const v1::Allocation allocation = ReadAllocation(path);
  EXPECT_EQ(allocation.readback().source(), absl::StrCat(a, ", ", b));
  ASSERT_EQ(allocation.lights_size(), 2);
  EXPECT_LE(allocation.texels(), 1024 * 1024);
}

TEST(AllocateSummary, ALightThatAllFramesLackStopsNoOtherAndOneThatSomeLackIsNamed) {
  const TemporaryFolder folder;
  const std::string without = folder.Path("without.summary"), sum = folder.Path("sum.summary");
  const std::string all = YardSummary(folder, "all.summary", {"--metric", "l2"});
  // A frame whose shadow channels have other names.
  EXPECT_EQ(RunLightfit({"summarize",
                         kRoom,
                         "--lights",
                         kYardLights,
                         "--metric",
                         "l2",
                         "--shadow-channel",
                         "no.{light}",
                         "-o",
                         without})
                .exit_code,
            2);
  for (const Arguments& goal : {Arguments{"--budget", "1024x1024"}, {"--tolerance", "rms:3"}}) {
    const ProcessResult none = AllocateSummary(without, goal);
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_THAT(none.err,
                AllOf(HasSubstr("no map for light \"sun\": nothing of it in 1 of 1 frames"),
                      Not(HasSubstr("warning"))));
    ASSERT_EQ(RunLightfit({"summarize", all, without, "-o", sum}).exit_code, 0);
    const ProcessResult some = AllocateSummary(sum, goal);
    EXPECT_EQ(some.exit_code, 0);
    EXPECT_THAT(some.err,
                AllOf(StartsWith("lightfit: warning: light \"key\": nothing of it in 1 of 2"),
                      HasSubstr("light \"sun\": nothing of it in 1 of 2")));
  }
}

TEST(AllocateSummary, WhatNeedsAReadBackIsRefusedWithTheWayOut) {
  const TemporaryFolder folder;
  const std::string sum = YardSummary(folder, "sum.summary");
  const std::string squares = YardSummary(folder, "squares.summary", {"--metric", "l2"});
  const Arguments budget = {"--budget", "1024x1024"};
  ExpectError(AllocateSummary(sum, {"--tolerance", "rms:1"}), 2, "again with --metric l2, or give");
  for (const char* tolerance : {"p99:1.5", "worst:3"}) {
    ExpectError(AllocateSummary(squares, {"--tolerance", tolerance}), 1, "want rms:PIXELS, or a");
  }
  ExpectError(
      AllocateSummary(sum, Joined(budget, {"--image", "720x720"})), 1, "half the tolerance");
  ExpectError(
      AllocateSummary(sum, Joined(budget, {"--lights", kYardLights})), 1, "hold the lights");
  ExpectError(AllocateSummary(sum, Joined(budget, {"--near", "1"})), 1, "--near: is about a");
  ExpectError(AllocateSummary(sum, Joined(budget, {"--metric", "l2"})), 2, "--metric l1-edge");
  ExpectError(AllocateSummary(sum, Joined(budget, {"--weight", "son=2"})), 2, "did you mean");
  ExpectError(AllocateSummary(sum, {"--budget", "100x100"}), 2, "want at least 12288");
  ExpectError(AllocateSummary(sum, {}), 1, "--budget WIDTHxHEIGHT or --tolerance");
  ExpectError(AllocateYard(Joined(budget, {"--summary", sum})), 1, "one of the two");
  ExpectError(RunLightfit(Joined({"allocate"}, budget)), 1, "a read-back or --summary");
  ExpectError(AllocateSummary(kYard, budget), 2, "no summary file");
}

// Every sample of every frame is measured in the matrices that came from the sums alone.
TEST(AllocateSummary, AToleranceOfAShotHoldsForTheSamplesOfItsFrames) {
  const std::string shot = RepositoryPath("../shared/readbacks/shot_walk");
  if (!std::filesystem::exists(shot)) GTEST_SKIP() << "no read-backs at " << shot;
  constexpr double kLimitPx = 1.5;
  const TemporaryFolder folder;
  const std::string sum = folder.Path("shot.summary"), json = folder.Path("maps.json");
  const Arguments frames = {shot + "/0001.exr", shot + "/0009.exr", shot + "/0017.exr"};
  const std::string scene = shot + "/scene.json";
  ASSERT_EQ(
      RunLightfit(Joined({"summarize", "--lights", scene, "--metric", "l2", "-o", sum}, frames))
          .exit_code,
      0);
  const ProcessResult result = AllocateSummary(sum, {"--tolerance", "rms:1.5", "--json", json});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("kept"), HasSubstr("pixels of all frames taken")));
  const v1::Allocation allocation = ReadAllocation(json);
  const absl::StatusOr<std::vector<Light>> lights = ReadLightsFile(scene);
  ASSERT_TRUE(lights.ok()) << lights.status();
  FitOptions squares;
  squares.metric = Metric::kL2;
  ASSERT_EQ(allocation.lights_size(), static_cast<int>(lights->size()));
  for (int i = 0; i < allocation.lights_size(); ++i) {
    const v1::LightResult& found = allocation.lights(i);
    const auto light = std::find_if(lights->begin(), lights->end(), [&](const Light& other) {
      return other.name == found.name();
    });
    ASSERT_NE(light, lights->end());
    double sum_squared = 0.0;
    int64_t num_samples = 0;
    for (const std::string& frame : frames) {
      const absl::StatusOr<ReadbackFile> file = ReadReadbackExr(frame, *lights);
      ASSERT_TRUE(file.ok()) << file.status();
      const absl::StatusOr<Figures> figures =
          EvaluateMatrix(file->View(),
                         *light,
                         MatrixOf(found.map_from_world()),
                         {found.map().width(), found.map().height()},
                         squares);
      ASSERT_TRUE(figures.ok()) << figures.status();
      EXPECT_EQ(figures->footprint.num_behind, 0);
      num_samples += figures->samples.used;
      sum_squared += static_cast<double>(figures->samples.used) * figures->footprint.rms *
                     figures->footprint.rms;
    }
    const double rms_px = std::sqrt(sum_squared / static_cast<double>(num_samples));
    const v1::ToleranceReached& reached = allocation.maps(i).reached();
    EXPECT_TRUE(reached.is_met());
    EXPECT_EQ(reached.num_samples(), num_samples);
    EXPECT_LE(rms_px, kLimitPx);
    EXPECT_NEAR(reached.reached_px(), rms_px, 1e-6);
  }
}

}  // namespace
}  // namespace lightfit
