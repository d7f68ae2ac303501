#include "optimizer/search/polish.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/testing/fit_station.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::kMinW;
using testing::Random;

constexpr Affine kFitters[] = {Affine::kMinAreaRectangle, Affine::kMinEnergyParallelogram};

TEST(PolishAxis, NeverWorseThanItsStart) {
  for (const Affine affine : kFitters) {
    for (const FitStation& station : FitStations(2, affine)) {
      const AffineFit start = station.Start();
      for (const Polish polish : {Polish::kQuick, Polish::kThorough, Polish::kExact}) {
        const SearchResult result =
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

// Exact: from wherever one comes, creases or not, the same optimum.
TEST(PolishAxis, ExactlyEndsInTheSameOptimum) {
  Random random(171);
  double widest = 0.0;
  for (const FitStation& station : FitStations(2, Affine::kMinEnergyParallelogram)) {
    SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
    const AffineFit thorough =
        PolishAxis(
            station.summary, station.problem, kMinW, Polish::kThorough, station.Start(evaluator))
            .fit;
    double least = HUGE_VAL, most = 0.0;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d move = 1e-3 * random.UnitVector().head<2>();
      const auto start = evaluator.Evaluate((AxisParameters(thorough) + move).homogeneous().eval());
      if (!start.has_value()) continue;
      const AffineFit exact =
          PolishAxis(station.summary, station.problem, kMinW, Polish::kExact, *start).fit;
      least = std::min(least, exact.energy);
      most = std::max(most, exact.energy);
    }
    EXPECT_LE(least, thorough.energy * (1.0 + 1e-12));
    EXPECT_LE(most, least * (1.0 + 1e-9)) << station.light.name;
    widest = std::max(widest, most / least - 1.0);
  }
  std::printf("energies from several starts: within %.1e\n", widest);
}

}  // namespace
}  // namespace lightfit
