// The metrics beside L2: each is never worse than its start in its own terms, recomputed here from
// the fitted matrix pixel by pixel.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "optimizer/fit.h"
#include "optimizer/footprint.h"
#include "optimizer/receivers.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::RelativeError;
using testing::TestScene;

constexpr MapSize kMap = {512, 512};
constexpr Metric kMetrics[] = {
    Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge};

// The metric of a fitted matrix from its rows and the samples' own footprints.
double MetricOf(const LightMatrix& matrix,
                const TestScene& scene,
                const Light& light,
                Metric metric) {
  const Receivers receivers = *FindReceivers(scene.View(), 1u << light.shadow_bit, {});
  const Samples samples = SelectSamples(receivers, light, Eigen::Matrix3d::Identity(), true);
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  Eigen::Matrix<double, 3, 4> rows;
  rows << matrix.map_from_world.topRows<2>(), matrix.map_from_world.row(3);
  const Eigen::Matrix3d map_from_ray =
      rows * ray_from_world.transpose() * (ray_from_world * ray_from_world.transpose()).inverse();
  const bool across = metric == Metric::kL2AcrossEdge || metric == Metric::kL1AcrossEdge;
  const bool root = metric == Metric::kL1 || metric == Metric::kL1AcrossEdge;
  double sum = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const Eigen::Matrix2d J = Footprint(map_from_ray, sample);
    double squared = J.squaredNorm();
    if (across) {
      squared = 0.05 * squared + (sample.edge_normal.isZero()
                                      ? squared
                                      : (sample.edge_normal.transpose() * J).squaredNorm());
    }
    sum += root ? std::sqrt(squared) : squared;
  }
  return sum;
}

TEST(FitLight, EnergyIsTheMetricOfTheMatrix) {
  int num_fitted = 0;
  for (const Metric metric : kMetrics) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const TestScene scene(seed, 3);
      for (const Light& light : scene.lights) {
        FitOptions options;
        options.metric = metric;
        const auto matrix = FitLight(scene.View(), light, kMap, options);
        if (!matrix.ok()) continue;
        EXPECT_LE(RelativeError(matrix->energy, MetricOf(*matrix, scene, light, metric)), 1e-6)
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
        EXPECT_LE(matrix->energy, matrix->energy_start) << matrix->BriefReport();
        EXPECT_LE(MetricOf(*matrix, scene, light, metric),
                  MetricOf(*start, scene, light, metric) * (1.0 + 1e-9));
        const auto l2 = FitLight(scene.View(), light, kMap);
        ASSERT_THAT(l2, IsOk());
        EXPECT_LE(matrix->energy, MetricOf(*l2, scene, light, metric) * 1.01)
            << static_cast<int>(metric) << " " << matrix->BriefReport();
        ++num_fitted;
      }
    }
    EXPECT_GE(num_fitted, 12);
  }
}

TEST(FitLight, MoreReweightingIsNeverWorse) {
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
        EXPECT_LE(matrix->energy, before);
        before = matrix->energy;
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
