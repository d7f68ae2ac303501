#include "optimizer/search/refine.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "geometry/ray_cone.h"
#include "tests/testing/fit_station.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/refiners.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::kMinW;
using testing::Random;
using testing::RelativeError;

TEST(ReducedEnergyCost, HalfSquaredResidualsAreTheEnergy) {
  Random random(161);
  for (const FitStation& station : FitStations(6, Affine::kMinEnergyParallelogram)) {
    const double unit = station.Start().energy;
    const ReducedEnergyCost cost(station.summary, station.problem, kMinW, unit);
    const Polygon polar = PolarPolygon(station.summary.cover.hull, 0.05);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d ab = testing::PointInPolygon(random, polar, random.Uniform(0.0, 1.0));
      Eigen::Matrix<double, 18, 1> residuals;
      ASSERT_TRUE(cost(ab.data(), residuals.data(), nullptr));
      const double sampled =
          Energy(cost.FitAt(ab)->map_from_ray, station.samples, station.summary.metric);
      EXPECT_LE(RelativeError(residuals.squaredNorm(), sampled / unit), 1e-9);
    }
  }
}

// J'r against central differences of the least energy itself, the affine part refitted at each
// step. Where the touched rays change between the steps there is a kink, and no derivative.
TEST(ReducedEnergyCost, AnalyticGradientEqualsDifferencesOfTheLeastEnergy) {
  constexpr double kStep = 1e-5;
  Random random(162);
  int num_smooth = 0, num_kinks = 0, num_wrong = 0;
  double worst = 0.0;
  for (const FitStation& station : FitStations(8, Affine::kMinEnergyParallelogram)) {
    const double unit = station.Start().energy;
    const ReducedEnergyCost cost(station.summary, station.problem, kMinW, unit);
    const Polygon polar = PolarPolygon(station.summary.cover.hull, 0.1);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d ab = testing::PointInPolygon(random, polar, random.Uniform(0.0, 1.0));
      Eigen::Matrix<double, 18, 1> residuals;
      Eigen::Matrix<double, 18, 2> jacobian;
      ASSERT_TRUE(cost(ab.data(), residuals.data(), jacobian.data()));
      const Eigen::Vector2d gradient = jacobian.transpose() * residuals;

      const auto half_energy = [&](const Eigen::Vector2d& at) {
        return 0.5 * cost.FitAt(at)->energy / unit;
      };
      Eigen::Vector2d differences;
      bool smooth = true;
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector2d h = kStep * Eigen::Vector2d::Unit(k);
        const double ahead = half_energy(ab + h), here = half_energy(ab),
                     behind = half_energy(ab - h);
        differences(k) = (ahead - behind) / (2.0 * kStep);
        // Slopes of the two sides differ by a jump at a kink, else by the step times the curvature.
        const double slope = std::abs(differences(k)) + here;
        smooth &= std::abs(ahead - 2.0 * here + behind) < 0.01 * kStep * slope;
      }
      if (!smooth) {
        ++num_kinks;
        continue;
      }
      ++num_smooth;
      const double error = (gradient - differences).norm() / (differences.norm() + half_energy(ab));
      worst = std::max(worst, error);
      if (error <= 1e-4) continue;
      ++num_wrong;
      std::printf("%s: analytic (%g, %g), numeric (%g, %g)\n",
                  station.light.name.c_str(),
                  gradient.x(),
                  gradient.y(),
                  differences.x(),
                  differences.y());
    }
  }
  std::printf("%d smooth, %d kinks, worst error %.2g\n", num_smooth, num_kinks, worst);
  EXPECT_GE(num_smooth, 20 * num_kinks);
  // A kink that is weak, or between one step and the next, passes for smooth now and then.
  EXPECT_LE(100 * num_wrong, num_smooth);
}

TEST(ReducedEnergyCost, RefusesAxesOutsideThePolarPolygon) {
  for (const FitStation& station : FitStations(2, Affine::kMinEnergyParallelogram)) {
    const ReducedEnergyCost cost(station.summary, station.problem, kMinW, station.Start().energy);
    const Eigen::Vector2d outside = 1.01 * PolarPolygon(station.summary.cover.hull, kMinW).front();
    Eigen::Matrix<double, 18, 1> residuals;
    EXPECT_FALSE(cost(outside.data(), residuals.data(), nullptr));
    EXPECT_TRUE(residuals.allFinite());
    EXPECT_FALSE(cost.FitAt({std::nan(""), 0.0}).has_value());
  }
}

constexpr Affine kFitters[] = {
    Affine::kMinAreaRectangle, Affine::kSkewedRectangle, Affine::kMinEnergyParallelogram};

TEST(RefineAxis, NeverWorseThanItsStart) {
  for (const Affine affine : kFitters) {
    int num_improved = 0;
    for (const FitStation& station : FitStations(5, affine)) {
      const AffineFit start = station.Start();
      for (const Refiner refiner : testing::Refiners()) {
        const SearchResult result =
            RefineAxis(station.summary, station.problem, kMinW, refiner, start);
        EXPECT_LE(result.fit.energy, start.energy);
        EXPECT_LE(RelativeError(result.fit.energy,
                                Energy(result.fit.map_from_ray, station.samples, {0.0, 1.0})),
                  1e-9);
        EXPECT_EQ(result.report.solver_report.empty(), refiner == Refiner::kTinySolver);
        num_improved += static_cast<int>(result.fit.energy < 0.99 * start.energy);
      }
    }
    EXPECT_GE(num_improved, 10);
  }
}

// Both minimise the same cost from the same start. Either may stop short at a kink, and they take
// different steps towards it, so the statement is about most lights.
TEST(RefineAxis, CeresAndTinySolverAgree) {
  if (!HasCeres()) GTEST_SKIP() << "this build has no Ceres";
  std::vector<double> differences;
  for (const FitStation& station : FitStations(8, Affine::kMinEnergyParallelogram)) {
    const AffineFit start = station.Start();
    const SearchResult tiny =
        RefineAxis(station.summary, station.problem, kMinW, Refiner::kTinySolver, start);
    const SearchResult ceres =
        RefineAxis(station.summary, station.problem, kMinW, Refiner::kCeres, start);
    differences.push_back(RelativeError(tiny.fit.energy, ceres.fit.energy));
  }
  std::sort(differences.begin(), differences.end());
  std::printf("energies differ by %.2g (median), %.2g (90 %%), %.2g (worst)\n",
              differences[differences.size() / 2],
              differences[differences.size() * 9 / 10],
              differences.back());
  EXPECT_LE(differences[differences.size() / 2], 0.03);
  EXPECT_LE(differences[differences.size() * 9 / 10], 0.15);
}

TEST(RefineAxis, KeepsAStartThatCannotBeRefined) {
  const FitStation station = FitStations(1, Affine::kMinEnergyParallelogram).front();
  AffineFit start = station.Start();
  for (const Refiner refiner : testing::Refiners()) {
    for (const double energy : {0.0, std::nan("")}) {
      start.energy = energy;
      const Eigen::Matrix3d before = start.map_from_ray;
      EXPECT_EQ(
          RefineAxis(station.summary, station.problem, kMinW, refiner, start).fit.map_from_ray,
          before);
    }
  }
}

}  // namespace
}  // namespace lightfit
