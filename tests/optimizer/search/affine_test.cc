#include "optimizer/search/affine.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "geometry/ray_cone.h"
#include "tests/testing/fit_station.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::FitStation;
using testing::FitStations;
using testing::IsOk;
using testing::PointInPolygon;
using testing::Random;
using testing::RelativeError;

constexpr Affine kFitters[] = {
    Affine::kMinAreaRectangle, Affine::kSkewedRectangle, Affine::kMinEnergyParallelogram};

// The extent of the hull in the map, (u, v) in texels.
struct TexelBox {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e300);
};

TexelBox BoxInMap(const Eigen::Matrix3d& map_from_ray, const Polygon& hull) {
  TexelBox box;
  for (const Eigen::Vector2d& ray : hull) {
    const Eigen::Vector3d map = map_from_ray * ray.homogeneous();
    EXPECT_GT(map.z(), 0.0);
    box.low = box.low.cwiseMin(map.hnormalized());
    box.high = box.high.cwiseMax(map.hnormalized());
  }
  return box;
}

TEST(FitAffine, FillsTheMapButForItsMargins) {
  Random random(171);
  for (const Affine affine : kFitters) {
    for (FitStation& station : FitStations(3, affine)) {
      station.problem.margin_percent = random.Uniform(0.0, 10.0);
      station.problem.margin_texels = random.Uniform(0.0, 20.0);
      SummaryEvaluator evaluator(station.summary, station.problem, testing::kMinW);
      const Polygon polar = PolarPolygon(station.summary.cover.hull, 0.05);
      for (int i = 0; i < 10; ++i) {
        const Eigen::Vector2d ab = PointInPolygon(random, polar, random.Uniform(0.0, 1.0));
        const auto fit = evaluator.Evaluate(ab.homogeneous());
        ASSERT_TRUE(fit.has_value());
        const TexelBox box = BoxInMap(fit->map_from_ray, station.summary.cover.hull);
        const InnerInterval u =
            InnerTexels(1024, station.problem.margin_percent, station.problem.margin_texels);
        const InnerInterval v =
            InnerTexels(512, station.problem.margin_percent, station.problem.margin_texels);
        EXPECT_NEAR(box.low.x(), u.low, 1e-6);
        EXPECT_NEAR(box.high.x(), u.high, 1e-6);
        EXPECT_NEAR(box.low.y(), v.low, 1e-6);
        EXPECT_NEAR(box.high.y(), v.high, 1e-6);
      }
    }
  }
}

TEST(FitAffine, EnergyIsThatOfTheMap) {
  Random random(172);
  for (const Affine affine : kFitters) {
    for (const RaySpace space : {RaySpace::kLightSpace, RaySpace::kNormalized}) {
      for (const FitStation& station : FitStations(3, affine, space)) {
        SummaryEvaluator evaluator(station.summary, station.problem, testing::kMinW);
        const Polygon polar = PolarPolygon(station.summary.cover.hull, 0.05);
        for (int i = 0; i < 10; ++i) {
          const Eigen::Vector2d ab = PointInPolygon(random, polar, random.Uniform(0.0, 1.0));
          const auto fit = evaluator.Evaluate(ab.homogeneous());
          ASSERT_TRUE(fit.has_value());
          const double expected = Energy(fit->map_from_ray, station.samples, {0.0, 1.0});
          EXPECT_LE(RelativeError(fit->energy, expected), 1e-9);
        }
      }
    }
  }
}

// math.md 5: no other fitter's shape has less energy at the same axis.
TEST(FitAffine, ParallelogramOfLeastEnergyIsNeverWorse) {
  Random random(173);
  for (FitStation& station : FitStations(4, Affine::kMinEnergyParallelogram)) {
    SummaryEvaluator least(station.summary, station.problem, testing::kMinW);
    const Polygon polar = PolarPolygon(station.summary.cover.hull, 0.05);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d ab = PointInPolygon(random, polar, random.Uniform(0.0, 1.0));
      const auto best = least.Evaluate(ab.homogeneous());
      ASSERT_TRUE(best.has_value());
      for (const Affine affine : {Affine::kMinAreaRectangle, Affine::kSkewedRectangle}) {
        AffineProblem problem = station.problem;
        problem.affine = affine;
        SummaryEvaluator other(station.summary, problem, testing::kMinW);
        EXPECT_LE(best->energy, other.Evaluate(ab.homogeneous())->energy * (1.0 + 1e-9));
      }
    }
  }
}

// The length of the axis is free, and what stands for it in the map too.
TEST(FitAffine, DoesNotDependOnTheAxisLength) {
  for (const Affine affine : kFitters) {
    for (const FitStation& station : FitStations(2, affine)) {
      SummaryEvaluator evaluator(station.summary, station.problem, testing::kMinW);
      const auto unit = evaluator.Evaluate({0.01, -0.02, 1.0});
      const auto scaled = evaluator.Evaluate({7.0, -14.0, 700.0});
      ASSERT_TRUE(unit.has_value() && scaled.has_value());
      EXPECT_LE(RelativeError(unit->energy, scaled->energy), 1e-12);
      EXPECT_LE((unit->map_from_ray - scaled->map_from_ray).norm(),
                1e-9 * unit->map_from_ray.norm());
    }
  }
}

// Long side to long side, whichever way the map lies.
TEST(FitAffine, LaysTheLongSideAlongTheLongSideOfTheMap) {
  const Polygon hull = {{-1.0, -0.25}, {1.0, -0.25}, {1.0, 0.25}, {-1.0, 0.25}};
  AffineProblem problem;
  problem.affine = Affine::kMinAreaRectangle;
  problem.normalized_from_ray.setIdentity();
  for (const MapSize& map : {MapSize{1024, 256}, MapSize{256, 1024}}) {
    problem.map = map;
    const auto fit =
        FitAffine(problem, hull, Eigen::Matrix3d::Identity(), Eigen::Vector3d::UnitZ());
    ASSERT_THAT(fit, IsOk());
    // Along x, the long side, a unit of rays takes 512 texels of the long side.
    const Eigen::Vector2d along = fit->map_from_ray.block<2, 1>(0, 0).cwiseAbs();
    EXPECT_NEAR(map.width > map.height ? along.x() : along.y(), 512.0, 1e-9);
    EXPECT_NEAR(map.width > map.height ? along.y() : along.x(), 0.0, 1e-9);
  }
}

TEST(FitAffine, CgalGivesTheSameRectangle) {
  for (const FitStation& station : FitStations(2, Affine::kMinAreaRectangle)) {
    AffineProblem problem = station.problem;
    problem.affine = Affine::kMinAreaRectangleCgal;
    const Eigen::Vector3d axis(0.01, 0.02, 1.0);
    const Eigen::Matrix3d metric = station.summary.tensor.AtAxis(axis);
    const auto from_cgal = FitAffine(problem, station.summary.cover.hull, metric, axis);
    if (from_cgal.status().code() == absl::StatusCode::kUnimplemented) {
      GTEST_SKIP() << "this build has no CGAL";
    }
    ASSERT_THAT(from_cgal, IsOk());
    const auto own = FitAffine(station.problem, station.summary.cover.hull, metric, axis);
    EXPECT_LE(RelativeError(own->energy, from_cgal->energy), 1e-9);
  }
}

TEST(InnerTexels, LeavesBothMargins) {
  EXPECT_EQ(InnerTexels(100.0, 0.0, 0.0).low, 0.0);
  EXPECT_EQ(InnerTexels(100.0, 0.0, 0.0).high, 100.0);
  EXPECT_DOUBLE_EQ(InnerTexels(100.0, 0.0, 3.0).low, 3.0);
  EXPECT_DOUBLE_EQ(InnerTexels(100.0, 0.0, 3.0).high, 97.0);
  // Grown by 10 % of its extent on both sides, 10 becomes 12.
  EXPECT_DOUBLE_EQ(InnerTexels(12.0, 10.0, 0.0).low, 1.0);
  EXPECT_DOUBLE_EQ(InnerTexels(12.0, 10.0, 0.0).high, 11.0);
}

}  // namespace
}  // namespace lightfit
