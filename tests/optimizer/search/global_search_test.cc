#include "optimizer/search/global_search.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "optimizer/fit.h"
#include "tests/testing/fit_station.h"
#include "tests/testing/matchers.h"
#include "tests/testing/refiners.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::kMinW;
using testing::TestScene;

constexpr MapSize kMap = {1024, 512};

TEST(GlobalSearch, NeverAboveItsStartAndEveryStationImproves) {
  for (const FitStation& station : FitStations(8, Affine::kMinEnergyParallelogram)) {
    for (const Refiner refiner : testing::Refiners()) {
      SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
      const AffineFit start = station.Start(evaluator);
      const SearchResult result = GlobalSearch(station.summary, evaluator, start, 10, refiner);
      EXPECT_LE(result.fit.energy, start.energy);
      EXPECT_EQ(result.report.trace.front().energy, start.energy);
      EXPECT_EQ(result.report.trace.back().energy, result.fit.energy);
      for (size_t i = 1; i < result.report.trace.size(); ++i) {
        EXPECT_LE(result.report.trace[i].energy, result.report.trace[i - 1].energy);
        EXPECT_GE(result.report.trace[i].evaluations, result.report.trace[i - 1].evaluations);
      }
      EXPECT_EQ(result.report.solver_report.empty(), refiner == Refiner::kTinySolver);
    }
  }
}

// The default search is at least as good as the published one and the focused one, in the same
// metric over the same samples and receivers.
TEST(GlobalSearch, NeverAbovePublishedAndFocused) {
  int num_compared = 0;
  double worst_excess = 0.0;
  for (uint64_t seed = 1; seed <= 15; ++seed) {
    const TestScene scene(seed, 6);
    for (const Light& light : scene.lights) {
      FitOptions published = FitOptions::AsPublished();
      published.sample_by_sample = false;
      FitOptions focused = testing::SquaredFootprints();
      focused.search = Search::kFocused;
      FitOptions line_search = testing::SquaredFootprints();
      line_search.search = Search::kRotationLineSearchRefined;
      const auto best = FitLight(scene.View(), light, kMap, testing::SquaredFootprints());
      if (!best.ok()) continue;
      for (const FitOptions& options : {published, focused}) {
        const auto other = FitLight(scene.View(), light, kMap, options);
        ASSERT_THAT(other, testing::IsOk());
        EXPECT_LE(best->figures.energy, other->figures.energy * (1.0 + 1e-9))
            << light.name << ", seed " << seed << ", search " << static_cast<int>(options.search);
      }
      const auto local = FitLight(scene.View(), light, kMap, line_search);
      ASSERT_THAT(local, testing::IsOk());
      worst_excess = std::max(worst_excess, best->figures.energy / local->figures.energy - 1.0);
      EXPECT_LE(best->figures.energy, best->search.energy_start);
      ++num_compared;
    }
  }
  EXPECT_GE(num_compared, 70);
  // A grid may start next to another local minimum than the line search, of nearly the same energy.
  std::printf("at most %.2g above the refined line search\n", worst_excess);
  EXPECT_LE(worst_excess, 1e-3);
}

// After the polish it matters little which solver refined.
TEST(GlobalSearch, RefinersEndAtNearlyTheSameEnergy) {
  if (!HasCeres()) GTEST_SKIP() << "this build has no Ceres";
  std::vector<double> differences;
  for (const FitStation& station : FitStations(10, Affine::kMinEnergyParallelogram)) {
    double energies[2] = {};
    for (const Refiner refiner : testing::Refiners()) {
      SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
      const AffineFit start = station.Start(evaluator);
      energies[static_cast<int>(refiner)] =
          GlobalSearch(station.summary, evaluator, start, 10, refiner).fit.energy;
    }
    differences.push_back(testing::RelativeError(energies[0], energies[1]));
  }
  std::sort(differences.begin(), differences.end());
  std::printf("energies differ by %.2g (median), %.2g (worst)\n",
              differences[differences.size() / 2],
              differences.back());
  EXPECT_LE(differences[differences.size() / 2], 1e-5);
  EXPECT_LE(differences.back(), 1e-2);
}

}  // namespace
}  // namespace lightfit
