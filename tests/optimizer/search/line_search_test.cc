#include "optimizer/search/line_search.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/testing/fit_station.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::kMinW;
using testing::RelativeError;

constexpr Affine kFitters[] = {
    Affine::kMinAreaRectangle, Affine::kSkewedRectangle, Affine::kMinEnergyParallelogram};
constexpr RaySpace kSpaces[] = {RaySpace::kLightSpace, RaySpace::kNormalized};

TEST(RotationLineSearch, NeverIncreasesEnergy) {
  for (const Affine affine : kFitters) {
    for (const RaySpace space : kSpaces) {
      for (const FitStation& station : FitStations(6, affine, space)) {
        SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
        const AffineFit start = station.Start(evaluator);
        const SearchResult result = RotationLineSearch(evaluator, start, 3);
        EXPECT_LE(result.fit.energy, start.energy);
        ASSERT_FALSE(result.report.trace.empty());
        EXPECT_EQ(result.report.trace.front().energy, start.energy);
        EXPECT_EQ(result.report.trace.back().energy, result.fit.energy);
        for (size_t i = 1; i < result.report.trace.size(); ++i) {
          EXPECT_LT(result.report.trace[i].energy, result.report.trace[i - 1].energy);
          EXPECT_GT(result.report.trace[i].evaluations, result.report.trace[i - 1].evaluations);
        }
      }
    }
  }
}

// The energy it reports is that of the map it returns, sample by sample.
TEST(RotationLineSearch, ReportsTheEnergyOfItsMap) {
  for (const Affine affine : kFitters) {
    for (const FitStation& station : FitStations(4, affine)) {
      SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
      const SearchResult result = RotationLineSearch(evaluator, station.Start(evaluator), 3);
      const double expected = Energy(result.fit.map_from_ray, station.samples, {0.0, 1.0});
      EXPECT_LE(RelativeError(result.fit.energy, expected), 1e-9);
    }
  }
}

TEST(RotationLineSearch, MoreRoundsAreNeverWorse) {
  for (const FitStation& station : FitStations(4, Affine::kMinAreaRectangle)) {
    double before = std::numeric_limits<double>::infinity();
    for (const int rounds : {1, 2, 3, 10, 40}) {
      SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
      const SearchResult result = RotationLineSearch(evaluator, station.Start(evaluator), rounds);
      EXPECT_LE(result.fit.energy, before);
      // k rounds cost at most 9 k evaluations, and those of the start.
      EXPECT_LE(evaluator.num_evaluations(), 9 * rounds + 2);
      before = result.fit.energy;
    }
  }
}

TEST(RotationLineSearch, SaysWhyItStopped) {
  int num_converged = 0, num_limited = 0;
  for (const FitStation& station : FitStations(4, Affine::kMinAreaRectangle)) {
    for (const int rounds : {1, 200}) {
      SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
      const SearchResult result = RotationLineSearch(evaluator, station.Start(evaluator), rounds);
      const bool converged = result.report.stop_reason == StopReason::kConverged;
      if (!converged) {
        EXPECT_EQ(result.report.stop_reason, StopReason::kRoundLimit);
      }
      if (rounds == 200) {
        EXPECT_TRUE(converged);
      }
      ++(converged ? num_converged : num_limited);
    }
  }
  EXPECT_GT(num_converged, 0);
  EXPECT_GT(num_limited, 0);
}

TEST(AxisEvaluator, RefusesAxesWithReceiversBehindThem) {
  for (const FitStation& station : FitStations(2, Affine::kMinEnergyParallelogram)) {
    SummaryEvaluator evaluator(station.summary, station.problem, kMinW);
    const Eigen::Vector2d ray = station.summary.cover.hull.front();
    EXPECT_FALSE(evaluator.Evaluate(Eigen::Vector3d(0, 0, -1)).has_value());
    EXPECT_FALSE(evaluator.Evaluate(Eigen::Vector3d(0, 0, 0)).has_value());
    EXPECT_FALSE(evaluator.Evaluate(Eigen::Vector3d(0, 0, std::nan(""))).has_value());
    EXPECT_FALSE(
        evaluator.Evaluate((-1.01 * ray / ray.squaredNorm()).homogeneous().eval()).has_value());
    EXPECT_EQ(evaluator.num_evaluations(), 0);
    EXPECT_TRUE(evaluator.Evaluate(Eigen::Vector3d(0, 0, 7)).has_value());
    EXPECT_EQ(evaluator.num_evaluations(), 1);
  }
}

}  // namespace
}  // namespace lightfit
