#include "optimizer/polish.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/testing/fit_station.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::kMinW;

constexpr Affine kFitters[] = {Affine::kMinAreaRectangle, Affine::kMinEnergyParallelogram};

TEST(PolishAxis, NeverWorseThanItsStart) {
  for (const Affine affine : kFitters) {
    for (const FitStation& station : FitStations(5, affine)) {
      const AffineFit start = station.Start();
      for (const Polish polish : {Polish::kQuick, Polish::kThorough}) {
        const RefineResult result =
            PolishAxis(station.summary, station.problem, kMinW, polish, start);
        EXPECT_LE(result.fit.energy, start.energy);
        EXPECT_TRUE(result.fit.map_from_ray.allFinite());
      }
    }
  }
}

// Thorough: no axis close by is better by more than the tolerance of the polish.
TEST(PolishAxis, LeavesNoBetterNeighbour) {
  for (const FitStation& station : FitStations(6, Affine::kMinEnergyParallelogram)) {
    SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
    const AffineFit polished =
        PolishAxis(
            station.summary, station.problem, kMinW, Polish::kThorough, station.Start(evaluator))
            .fit;
    const Eigen::Vector2d ab =
        polished.map_from_ray.row(2).head<2>().transpose() / polished.map_from_ray(2, 2);
    for (const double step : {1e-3, 5e-3, 2e-2}) {
      for (int direction = 0; direction < 16; ++direction) {
        const double angle = direction * M_PI / 8.0;
        const Eigen::Vector2d move = step * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const auto neighbour = evaluator.Evaluate((ab + move).homogeneous().eval());
        if (!neighbour.has_value()) continue;
        EXPECT_GE(neighbour->energy, polished.energy * (1.0 - 1e-3)) << station.light.name;
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
