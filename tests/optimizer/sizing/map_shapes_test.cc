// What a few fits say about maps of every size, against fits of those sizes.
#include "optimizer/sizing/map_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/search/axis_search.h"
#include "optimizer/sizing/map_sizes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;
using testing::TestScene;

constexpr Metric kMetrics[] = {Metric::kL2, Metric::kL1AcrossEdge};

// Calls check(summary, light, options) for the lights of a few scenes that can be fitted.
template <typename Check>
void ForEachSummary(int num_scenes, const Check& check) {
  int num_checked = 0;
  for (int seed = 1; seed <= num_scenes; ++seed) {
    std::printf("[   seed   ] %d\n", seed);
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      for (const Metric metric : kMetrics) {
        FitOptions options;
        options.metric = metric;
        const absl::StatusOr<Summary> summary = Summarize(scene.View(), light, options);
        if (!summary.ok() || !FitMatrix({light, *summary}, {512, 512}, options).ok()) continue;
        check(*summary, light, options);
        ++num_checked;
      }
    }
  }
  EXPECT_GE(num_checked, 2 * num_scenes);
}

double FittedEnergy(const Summary& summary,
                    const Light& light,
                    MapSize map,
                    const FitOptions& options) {
  const absl::StatusOr<LightMatrix> fit = FitMatrix({light, summary}, map, options);
  EXPECT_THAT(fit, IsOk());
  return fit.ok() ? fit->figures.energy : 0.0;
}

// math.md (9) and (15): stretching a map leaves its shape and divides A and B by other sizes. The
// twin is the energy of the stretched matrix.
TEST(MapShapes, FixedShapesScaleAsFormulaFifteenSays) {
  constexpr double kTolerance = 1e-9;
  ForEachSummary(2, [](const Summary& summary, const Light& light, const FitOptions& options) {
    const absl::StatusOr<SearchResult> outcome = SearchAxis({light, summary}, {1024, 512}, options);
    ASSERT_TRUE(outcome.ok()) << outcome.status();
    const Eigen::Matrix3d fitted = outcome->fit.map_from_ray;
    const auto energy = [&](double width, double height) {
      const Eigen::Vector3d stretch(width / 1024, height / 512, 1.0);
      const Eigen::Matrix3d map_from_ray = stretch.asDiagonal() * fitted;
      return summary.tensor.Energy(map_from_ray);
    };
    // Two sizes tell A and B; every other follows.
    Eigen::Matrix2d law;
    law << 1.0, 1.0, 0.25, 1.0;
    const Eigen::Vector2d ab =
        law.partialPivLu().solve(Eigen::Vector2d(energy(1.0, 1.0), energy(2.0, 1.0)));
    for (const auto& [width, height] : {std::pair{300.0, 700.0}, std::pair{4096.0, 64.0}}) {
      const double expected = ab(0) / (width * width) + ab(1) / (height * height);
      EXPECT_NEAR(energy(width, height) / expected, 1.0, kTolerance);
    }
    const double best = std::sqrt(ab(0) / ab(1)), texels = 1e6;
    EXPECT_NEAR(energy(std::sqrt(texels * best), std::sqrt(texels / best)) /
                    (2.0 * std::sqrt(ab(0) * ab(1)) / texels),
                1.0,
                kTolerance);
    for (const double factor : {0.9, 1.1}) {
      const double aspect = factor * best;
      EXPECT_GT(energy(std::sqrt(texels * aspect), std::sqrt(texels / aspect)),
                energy(std::sqrt(texels * best), std::sqrt(texels / best)));
    }
  });
}

// A fit may be this much above the shapes' bound, as its search is not exact.
constexpr double kSearchTolerance = 2e-3;

TEST(MapShapes, ForetellWhatAFitOfAnySizeReaches) {
  Random random(3);
  double least_ratio = 1.0, largest_ratio = 0.0;
  ForEachSummary(4, [&](const Summary& summary, const Light& light, const FitOptions& options) {
    const absl::StatusOr<MapShapes> shapes = FindMapShapes(summary, light, options);
    ASSERT_TRUE(shapes.ok()) << shapes.status();
    for (int i = 0; i < 5; ++i) {
      const double side = random.LogUniform(128, 4096), stretch = random.LogUniform(0.25, 4.0);
      const MapSize map = {static_cast<int>(side * stretch), static_cast<int>(side / stretch)};
      const double ratio =
          FittedEnergy(summary, light, map, options) / shapes->Energy(map.width, map.height);
      least_ratio = std::min(least_ratio, ratio);
      largest_ratio = std::max(largest_ratio, ratio);
    }
  });
  std::printf("fitted energy / foretold: %.5f ... %.5f\n", least_ratio, largest_ratio);
  EXPECT_LE(largest_ratio, 1.0 + kSearchTolerance);
  EXPECT_GE(least_ratio, 0.97);  // aspects half an octave apart
}

TEST(MapShapes, BestAspectIsThatOfADenseScan) {
  double worst_ratio = 0.0;
  ForEachSummary(3, [&](const Summary& summary, const Light& light, const FitOptions& options) {
    const absl::StatusOr<MapShapes> shapes = FindMapShapes(summary, light, options);
    ASSERT_TRUE(shapes.ok()) << shapes.status();
    constexpr int kSteps = 32;  // to four octaves
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSteps; ++i) {
      const double aspect = std::exp2(4.0 * i / kSteps);
      const MapSize map = {static_cast<int>(std::lround(4096 * std::sqrt(aspect))),
                           static_cast<int>(std::lround(4096 / std::sqrt(aspect)))};
      const double scale = std::pow(static_cast<double>(TexelsOf(map)), shapes->Exponent());
      least = std::min(least, scale * FittedEnergy(summary, light, map, options));
    }
    worst_ratio = std::max(worst_ratio, shapes->UnitEnergy() / least);
  });
  std::printf("best aspect's energy / dense scan's, worst: %.6f\n", worst_ratio);
  EXPECT_LE(worst_ratio, 1.0 + kSearchTolerance);
}

TEST(MapShapes, BestSizeHasTheUnitEnergyAndEveryOtherMore) {
  ForEachSummary(2, [](const Summary& summary, const Light& light, const FitOptions& options) {
    const absl::StatusOr<MapShapes> shapes = FindMapShapes(summary, light, options);
    ASSERT_TRUE(shapes.ok()) << shapes.status();
    constexpr double kTexels = 1e6;
    const double unit = shapes->UnitEnergy() * std::pow(kTexels, -shapes->Exponent());
    const double aspect = shapes->BestAspect();
    EXPECT_GE(aspect, 1.0);
    EXPECT_NEAR(
        shapes->Energy(std::sqrt(kTexels * aspect), std::sqrt(kTexels / aspect)) / unit, 1.0, 1e-9);
    for (double other = 1.0 / 16; other <= 16.0; other *= 1.1) {
      EXPECT_GE(shapes->Energy(std::sqrt(kTexels * other), std::sqrt(kTexels / other)),
                unit * (1.0 - 1e-9));
    }
  });
}

TEST(MapShapes, KeepMarginsInTexelsApart) {
  ForEachSummary(1, [](const Summary& summary, const Light& light, FitOptions options) {
    options.margin_texels = 20.0;
    const absl::StatusOr<MapShapes> shapes = FindMapShapes(summary, light, options);
    ASSERT_TRUE(shapes.ok()) << shapes.status();
    for (const MapSize map : {MapSize{128, 64}, MapSize{300, 300}}) {
      const double ratio =
          FittedEnergy(summary, light, map, options) / shapes->Energy(map.width, map.height);
      EXPECT_LE(ratio, 1.0 + kSearchTolerance);
      EXPECT_GE(ratio, 0.97);
    }
    EXPECT_TRUE(std::isinf(shapes->Energy(400, 40)));
  });
}

// Weighing in the best map of all aspects, energies from the summary are those of the samples.
TEST(SummarizeForAnyAspect, LowersTheBoundToWhatFitsOfTheReadBackReach) {
  constexpr double kTolerance = 0.01;
  int num_gained = 0;
  for (const int seed : {1, 2, 3}) {
    std::printf("[   seed   ] %d\n", seed);
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      const FitOptions options;
      const absl::StatusOr<Summary> square = Summarize(scene.View(), light, options);
      if (!square.ok() || !FitMatrix({light, *square}, {512, 512}, options).ok()) continue;
      const absl::StatusOr<Summary> summary = SummarizeForAnyAspect(scene.View(), light, options);
      ASSERT_TRUE(summary.ok()) << summary.status();
      const absl::StatusOr<MapShapes> before = FindMapShapes(*square, light, options);
      const absl::StatusOr<MapShapes> after = FindMapShapes(*summary, light, options);
      ASSERT_TRUE(before.ok() && after.ok());
      EXPECT_LE(after->UnitEnergy(), before->UnitEnergy() * (1.0 + 1e-12));
      if (after->UnitEnergy() < 0.99 * before->UnitEnergy()) ++num_gained;
      const double aspect = after->BestAspect();
      const MapSize map = {static_cast<int>(std::lround(4096 * std::sqrt(aspect))),
                           static_cast<int>(std::lround(4096 / std::sqrt(aspect)))};
      const absl::StatusOr<LightMatrix> fit = FitLight(scene.View(), light, map, options);
      ASSERT_TRUE(fit.ok()) << fit.status();
      EXPECT_NEAR(after->Energy(map.width, map.height) / fit->figures.energy, 1.0, kTolerance)
          << light.name;
    }
  }
  EXPECT_GT(num_gained, 0);
}

TEST(MapShapes, NeedSamples) {
  TestScene scene(1, 1);
  scene.readback.shadow_bits.assign(scene.readback.shadow_bits.size(), 0);
  FitOptions options;
  const absl::StatusOr<Summary> summary = Summarize(scene.View(), scene.lights[0], options);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_THAT(FindMapShapes(*summary, scene.lights[0], options),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no shadow boundary")));
  options.search = Search::kFocused;  // fits without samples, but no size is better than another
  EXPECT_THAT(FindMapShapes(*summary, scene.lights[0], options),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("leave the light out")));
}

}  // namespace
}  // namespace lightfit
