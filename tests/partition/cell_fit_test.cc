#include "partition/cell_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "optimizer/energy/footprint.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit.h"
#include "tests/partition/plan_case.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HasShadows;
using testing::PlanCase;
using testing::Random;

// The sample by sample reference.
TEST(MapExtents, AreTheSquaredFootprintsOfTheReference) {
  constexpr double kRounding = 1e-9;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const PlanCase at(seed, 0);
    Random random(seed);
    const MetricWeights metric = WeightsOf(at.fit.metric, at.fit.along_edge_share);
    Eigen::Matrix3d map_from_ray = Eigen::Matrix3d::Identity();
    map_from_ray.topRows<2>() *= random.LogUniform(10.0, 1000.0);
    map_from_ray.row(2) << random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), 1.0;
    const MapExtents extents(map_from_ray);
    for (size_t i = 0; i < at.view.samples.size(); ++i) {
      const Sample sample = at.view.samples.At(i);
      const Eigen::Matrix2d footprint = Footprint(map_from_ray, sample);
      const Extents of =
          extents.Of({sample.X, ToSymmetricVector(MetricTensor(sample, metric)), 1.0});
      const auto squared = [&](int column) {
        const Eigen::Vector2d extent = footprint.col(column);
        const double across = sample.edge_normal.dot(extent);
        return sample.edge_normal.isZero()
                   ? (metric.whole + metric.across_edge) * extent.squaredNorm()
                   : metric.whole * extent.squaredNorm() + metric.across_edge * across * across;
      };
      EXPECT_NEAR(of.along_u / squared(0), 1.0, kRounding);
      EXPECT_NEAR(of.along_v / squared(1), 1.0, kRounding);
    }
  }
}

TEST(CellFitter, TheMapHoldsAllThatIsCoveredAndItsEnergyIsThatOfItsSamples) {
  constexpr double kWholeTexels = 2e-3;  // sides are fitted in whole texels of 1024 or so
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      ++num_cases;
      const CellFitter fitter = at.Fitter();
      const std::vector<int> bins = at.AllBins();
      const std::optional<CellMap> map = fitter.Fit(bins);
      ASSERT_TRUE(map.has_value()) << at.light.name << " seed " << seed;
      EXPECT_NEAR(map->width * map->height / kCellTexels, 1.0, 1e-12);
      for (const RayBin& bin : at.rays.bins) {
        for (const Eigen::Vector3d& ray : bin.hull) {
          const Eigen::Vector3d at_ray = map->map_from_ray * ray;
          ASSERT_GT(at_ray.z(), 0.0);
          EXPECT_GE(at_ray.x() / at_ray.z(), 0.0);
          EXPECT_LE(at_ray.x() / at_ray.z(), map->width * (1.0 + kWholeTexels));
          EXPECT_GE(at_ray.y() / at_ray.z(), 0.0);
          EXPECT_LE(at_ray.y() / at_ray.z(), map->height * (1.0 + kWholeTexels));
        }
      }
      // Boundary samples by the library's own figures, the rest by hand.
      double energy =
          MeasureFigures(at.view.samples, map->map_from_ray, at.fit.metric, at.fit.along_edge_share)
              .energy;
      const MapExtents extents(map->map_from_ray);
      for (const RaySample& sample : at.rays.samples) {
        if (sample.weight == 1.0) continue;
        const Extents of = extents.Of(sample);
        energy += sample.weight * std::sqrt(of.along_u + of.along_v);
      }
      EXPECT_NEAR(map->energy / energy, 1.0, 1e-9);
    }
  }
  EXPECT_GE(num_cases, 6);
}

// A free aspect, and the same samples but for the floor: no worse than the square map of the fit of
// one light, but for what the corners of pixels take.
TEST(CellFitter, OneCellOfAllIsAboutTheFitOfTheLight) {
  constexpr double kCornersAndFloor = 1.15;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanCase at(seed, 0);
    if (!HasShadows(at)) continue;
    const std::optional<CellMap> map = at.Fitter().Fit(at.AllBins());
    ASSERT_TRUE(map.has_value());
    const auto light = FitLight(at.view, {1024, 1024}, at.fit);
    ASSERT_THAT(light, testing::IsOk());
    const double energy =
        MeasureFigures(at.view.samples, map->map_from_ray, at.fit.metric, at.fit.along_edge_share)
            .energy;
    EXPECT_LT(energy, kCornersAndFloor * light->figures.energy) << "seed " << seed;
  }
}

TEST(CellFitter, RefittingNeverEndsAboveWhereTheRoundsBegan) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanCase at(seed, 0);
    if (!HasShadows(at)) continue;
    const CellFitter fitter = at.Fitter();
    const std::vector<int> bins = at.AllBins();
    const std::optional<CellMap> map = fitter.Fit(bins);
    ASSERT_TRUE(map.has_value());
    const std::optional<CellMap> again = fitter.Refit(bins, *map);
    ASSERT_TRUE(again.has_value());
    constexpr double kWholeTexels = 1e-2;  // an aspect is rounded to whole sides
    EXPECT_LT(again->energy, (1.0 + kWholeTexels) * map->energy) << "seed " << seed;
  }
}

TEST(CellFitter, AMapOfAnySizeHoldsItsCellWithinTheGuard) {
  constexpr double kGuard = 3.0, kRounding = 1e-6;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanCase at(seed, 0);
    if (!HasShadows(at)) continue;
    const CellFitter fitter = at.Fitter();
    const std::vector<int> bins = at.AllBins();
    const std::optional<CellMap> map = fitter.Fit(bins);
    ASSERT_TRUE(map.has_value());
    for (const MapSize size : {MapSize{64, 32}, MapSize{300, 300}, MapSize{100, 900}}) {
      const auto sized = fitter.MapOfSize(bins, *map, size, kGuard);
      ASSERT_TRUE(sized.has_value());
      for (const RayBin& bin : at.rays.bins) {
        for (const Eigen::Vector3d& ray : bin.hull) {
          const Eigen::Vector2d texel = (*sized * ray).hnormalized();
          EXPECT_GE(texel.minCoeff(), kGuard - kRounding);
          EXPECT_LE(texel.x(), size.width - kGuard + kRounding);
          EXPECT_LE(texel.y(), size.height - kGuard + kRounding);
        }
      }
    }
  }
}

TEST(CellFitter, ThereIsNoMapOfNothing) {
  const PlanCase at(1, 0);
  EXPECT_FALSE(at.Fitter().Fit({}).has_value());
}

}  // namespace
}  // namespace lightfit
