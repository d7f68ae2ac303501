// The metrics beside L2: each is never worse than its start in its own terms, recomputed here from
// the fitted matrix pixel by pixel.
#include <gtest/gtest.h>

#include <limits>

#include "optimizer/fit.h"
#include "tests/testing/matchers.h"
#include "tests/testing/metric_of.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::MetricOf;
using testing::RelativeError;
using testing::TestScene;

constexpr MapSize kMap = {512, 512};
constexpr Metric kMetrics[] = {
    Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge};

TEST(FitLight, EnergyIsTheMetricOfTheMatrix) {
  // Through the 4x4 of a far light, whose rounding counts most on surfaces nearly edge-on to it.
  constexpr double kTolerance = 5e-6;
  int num_fitted = 0;
  for (const Metric metric : kMetrics) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const TestScene scene(seed, 3);
      for (const Light& light : scene.lights) {
        FitOptions options;
        options.metric = metric;
        const auto matrix = FitLight(scene.View(), light, kMap, options);
        if (!matrix.ok()) continue;
        EXPECT_LE(
            RelativeError(matrix->figures.energy, MetricOf(*matrix, scene.View(), light, options)),
            kTolerance)
            << static_cast<int>(metric) << " " << matrix->BriefReport();
        ++num_fitted;
      }
    }
  }
  EXPECT_GE(num_fitted, 45);
}

// Each metric's fit is no worse in it than the focused map, and than the L2 fit (but for the little
// that one local search may be ahead of another).
TEST(FitLight, EveryMetricIsNeverWorseThanItsStart) {
  for (const Metric metric : kMetrics) {
    int num_fitted = 0;
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const TestScene scene(seed, 3);
      for (const Light& light : scene.lights) {
        FitOptions options, focused;
        options.metric = focused.metric = metric;
        focused.search = Search::kFocused;
        const auto matrix = FitLight(scene.View(), light, kMap, options);
        const auto start = FitLight(scene.View(), light, kMap, focused);
        if (!matrix.ok()) continue;
        ASSERT_THAT(start, IsOk());
        EXPECT_LE(matrix->figures.energy, matrix->search.energy_start) << matrix->BriefReport();
        EXPECT_LE(MetricOf(*matrix, scene.View(), light, options),
                  MetricOf(*start, scene.View(), light, options) * (1.0 + 1e-9));
        FitOptions squared;
        squared.metric = Metric::kL2;
        const auto l2 = FitLight(scene.View(), light, kMap, squared);
        ASSERT_THAT(l2, IsOk());
        EXPECT_LE(matrix->figures.energy, MetricOf(*l2, scene.View(), light, options) * 1.01)
            << static_cast<int>(metric) << " " << matrix->BriefReport();
        ++num_fitted;
      }
    }
    EXPECT_GE(num_fitted, 12);
  }
}

// But for what the polish of all rounds but the last leaves undone.
TEST(FitLight, MoreReweightingIsNeverWorse) {
  constexpr double kQuickPolish = 1e-3;  // see Polish::kQuick
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      double before = std::numeric_limits<double>::infinity();
      for (const int rounds : {1, 2, 5, 10}) {
        FitOptions options;
        options.metric = Metric::kL1;
        options.reweighting_rounds = rounds;
        const auto matrix = FitLight(scene.View(), light, kMap, options);
        if (!matrix.ok()) continue;
        EXPECT_LE(matrix->figures.energy, before * (1.0 + kQuickPolish));
        before = matrix->figures.energy;
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
