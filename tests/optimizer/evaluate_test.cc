#include "optimizer/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::TestScene;

constexpr MapSize kMap = {512, 384};

// A fit's own figures and those of its matrix are two ways to the same: there the summary or the
// last round of reweighting, here the sum over samples in other coordinates.
TEST(EvaluateMatrix, FindsTheFiguresOfAFit) {
  constexpr double kTolerance = 1e-7;  // through the 4x4 and other normalised rays
  int num_compared = 0;
  for (const uint64_t seed : {1u, 2u, 3u}) {
    std::printf("[   seed   ] %d\n", static_cast<int>(seed));
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      for (const Metric metric :
           {Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge}) {
        FitOptions options;
        options.metric = metric;
        const absl::StatusOr<LightMatrix> fit = FitLight(scene.View(), light, kMap, options);
        if (!fit.ok()) continue;
        const absl::StatusOr<Figures> figures =
            EvaluateMatrix(scene.View(), light, fit->map_from_world, kMap, options);
        ASSERT_TRUE(figures.ok()) << figures.status();
        if (figures->footprint.num_behind > 0) continue;  // lit pixels next to what is covered
        EXPECT_NEAR(figures->energy / fit->figures.energy, 1.0, kTolerance) << light.name;
        EXPECT_NEAR(figures->footprint.rms / fit->figures.footprint.rms, 1.0, kTolerance);
        EXPECT_NEAR(figures->footprint.worst / fit->figures.footprint.worst, 1.0, kTolerance);
        EXPECT_EQ(figures->samples.used, fit->figures.samples.used);
        EXPECT_EQ(figures->wrong_share,
                  *ForetellWrongShare(scene.View(), light, fit->map_from_world, kMap));
        ++num_compared;
      }
    }
  }
  EXPECT_GT(num_compared, 20);
}

TEST(EvaluateMatrix, RefusesTheMatrixOfAnotherLight) {
  const TestScene scene(1, 3);
  const absl::StatusOr<LightMatrix> fit = FitLight(scene.View(), scene.lights[0], kMap);
  ASSERT_TRUE(fit.ok()) << fit.status();
  const absl::StatusOr<Figures> figures =
      EvaluateMatrix(scene.View(), scene.lights[1], fit->map_from_world, kMap);
  EXPECT_EQ(figures.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(figures.status().message()), HasSubstr("do not leave the light"));
}

TEST(EvaluateMatrix, SaysWhenAMapLooksTheOtherWay) {
  const TestScene scene(1, 1);
  absl::StatusOr<LightMatrix> fit = FitLight(scene.View(), scene.lights[0], kMap);
  ASSERT_TRUE(fit.ok()) << fit.status();
  fit->map_from_world = -fit->map_from_world;  // the same places, all with w < 0
  const absl::StatusOr<Figures> figures =
      EvaluateMatrix(scene.View(), scene.lights[0], fit->map_from_world, kMap);
  EXPECT_EQ(figures.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(figures.status().message()), HasSubstr("w <= 0 at all"));
}

TEST(EvaluateMatrix, HasNothingToSumWithoutShadowEdges) {
  TestScene scene(1, 1);
  absl::StatusOr<LightMatrix> fit = FitLight(scene.View(), scene.lights[0], kMap);
  ASSERT_TRUE(fit.ok()) << fit.status();
  scene.readback.shadow_bits.assign(scene.readback.shadow_bits.size(), 0);
  const absl::StatusOr<Figures> figures =
      EvaluateMatrix(scene.View(), scene.lights[0], fit->map_from_world, kMap);
  ASSERT_TRUE(figures.ok()) << figures.status();
  EXPECT_EQ(figures->energy, 0.0);
  EXPECT_EQ(figures->footprint.rms, 0.0);
  EXPECT_EQ(figures->wrong_share, 0.0);
}

}  // namespace
}  // namespace lightfit
