#include "geometry/enclosing_rectangle.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "geometry/convex_hull.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/shapes.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::MinRectangleAreaOverEdges;
using testing::Overhang;
using testing::Random;
using testing::RandomPolygon;

bool HasCgal() {
  return MinAreaRectangleCgal({{0, 0}, {1, 0}, {0, 1}}).status().code() !=
         absl::StatusCode::kUnimplemented;
}

constexpr int kNumCases = 1000;  // of each property

// Grid points make parallel edges and right angles, which random reals never do.
Polygon GridPolygon(Random& random) {
  while (true) {
    std::vector<Eigen::Vector2d> points(random.Int(3, 25));
    for (Eigen::Vector2d& point : points) {
      point.x() = random.Int(-9, 9);
      point.y() = random.Int(-9, 9);
    }
    const Polygon hull = ConvexHull(points);
    if (hull.size() >= 3) return hull;
  }
}

TEST(MinAreaRectangle, EqualsBruteForceOverEdges) {
  Random random(71);
  for (int i = 0; i < kNumCases; ++i) {
    const Polygon polygon = GridPolygon(random);
    const Parallelogram rectangle = MinAreaRectangle(polygon);
    const double expected = MinRectangleAreaOverEdges(polygon);
    ASSERT_TRUE(std::abs(Area(rectangle) - expected) <= 1e-12 * expected);
    ASSERT_LE(Overhang(rectangle, polygon), 1e-12);
    ASSERT_TRUE(std::abs(rectangle.edge_u.dot(rectangle.edge_v)) <=
                1e-12 * rectangle.edge_u.norm() * rectangle.edge_v.norm());
  }
}

TEST(MinAreaRectangle, EqualsCgal) {
  if (!HasCgal()) GTEST_SKIP() << "this build has no CGAL";
  Random random(72);
  for (int i = 0; i < kNumCases; ++i) {
    const Polygon polygon = GridPolygon(random);
    const absl::StatusOr<Parallelogram> from_cgal = MinAreaRectangleCgal(polygon);
    ASSERT_TRUE(from_cgal.ok());
    ASSERT_TRUE(std::abs(Area(MinAreaRectangle(polygon)) - Area(*from_cgal)) <=
                1e-12 * Area(*from_cgal));
    ASSERT_LE(Overhang(*from_cgal, polygon), 1e-12);
  }
}

TEST(MinAreaSkewedRectangle, EnclosesAndIsNeverLarger) {
  Random random(73);
  for (int i = 0; i < kNumCases; ++i) {
    const Polygon polygon = GridPolygon(random);
    const Parallelogram skewed = MinAreaSkewedRectangle(polygon);
    ASSERT_LE(Overhang(skewed, polygon), 1e-12);
    ASSERT_TRUE(Area(skewed) <= Area(MinAreaRectangle(polygon)) * (1.0 + 1e-12));
    ASSERT_TRUE(Area(skewed) >= Area(polygon) * (1.0 - 1e-12));
  }
}

TEST(MinAreaRectangle, EqualsCgalAndBruteForceOnSlivers) {
  Random random(61);
  for (int i = 0; i < 500; ++i) {
    const Polygon polygon = RandomPolygon(random, random.Int(3, 40), 1e4);
    const double expected = MinRectangleAreaOverEdges(polygon);
    EXPECT_LE(testing::RelativeError(Area(MinAreaRectangle(polygon)), expected), 1e-9) << i;
    EXPECT_LE(Overhang(MinAreaRectangle(polygon), polygon), 1e-9) << i;
    EXPECT_LE(Overhang(MinAreaSkewedRectangle(polygon), polygon), 1e-9) << i;
    if (!HasCgal()) continue;
    const absl::StatusOr<Parallelogram> from_cgal = MinAreaRectangleCgal(polygon);
    ASSERT_THAT(from_cgal, IsOk());
    EXPECT_LE(testing::RelativeError(Area(*from_cgal), expected), 1e-9) << i;
  }
}

TEST(MinAreaRectangle, DoesNotDependOnTheFirstVertex) {
  Random random(62);
  for (int i = 0; i < 100; ++i) {
    Polygon polygon = RandomPolygon(random, random.Int(3, 20), 10.0);
    const double area = Area(MinAreaRectangle(polygon));
    for (size_t k = 0; k < polygon.size(); ++k) {
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
      EXPECT_LE(testing::RelativeError(Area(MinAreaRectangle(polygon)), area), 1e-12);
    }
  }
}

// Fig. 3 of Chong & Gortler: a trapezoid that leans to one side.
TEST(MinAreaSkewedRectangle, ShearsALeaningParallelogramUpright) {
  const Polygon leaning = {{0, 0}, {4, 0}, {6, 2}, {2, 2}};
  EXPECT_NEAR(Area(MinAreaSkewedRectangle(leaning)), 8.0, 1e-12);
  EXPECT_GT(Area(MinAreaRectangle(leaning)), 9.0);
}

using Fitter = Parallelogram (*)(const Polygon&);
constexpr Fitter kFitters[] = {&MinAreaRectangle, &MinAreaSkewedRectangle};

TEST(MinAreaRectangle, PolygonWithoutAreaGivesRectangleWithoutArea) {
  const Polygon degenerate[] = {{}, {{1.0, 2.0}}, {{1.0, 2.0}, {4.0, 6.0}}};
  for (const Polygon& polygon : degenerate) {
    for (const Fitter fitter : kFitters) {
      const Parallelogram rectangle = fitter(polygon);
      EXPECT_EQ(Area(rectangle), 0.0);
      EXPECT_TRUE(rectangle.corner.allFinite());
      if (polygon.size() == 2) {
        EXPECT_DOUBLE_EQ(rectangle.edge_u.norm() + rectangle.edge_v.norm(), 5.0);
      }
    }
    const absl::StatusOr<Parallelogram> from_cgal = MinAreaRectangleCgal(polygon);
    if (from_cgal.ok()) {
      EXPECT_EQ(Area(*from_cgal), 0.0);
    }
  }
}

TEST(MinAreaRectangle, CollinearPointsGiveNoArea) {
  const Polygon hull = ConvexHull({{0, 0}, {1, 1}, {2, 2}, {3, 3}});
  for (const Fitter fitter : kFitters) EXPECT_EQ(Area(fitter(hull)), 0.0);
}

TEST(MinAreaRectangleCgal, RejectsVerticesThatAreNotFinite) {
  if (!HasCgal()) GTEST_SKIP() << "this build has no CGAL";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(MinAreaRectangleCgal({{0, 0}, {1, nan}, {0, 1}}),
              testing::StatusIs(absl::StatusCode::kInvalidArgument,
                                ::testing::HasSubstr("polygon: a vertex is not finite")));
}

TEST(MinAreaRectangleCgal, SaysWhatToUseInsteadWhereItIsMissing) {
  if (HasCgal()) GTEST_SKIP() << "this build has CGAL";
  EXPECT_THAT(MinAreaRectangleCgal({{0, 0}, {1, 0}, {0, 1}}),
              testing::StatusIs(absl::StatusCode::kUnimplemented,
                                ::testing::HasSubstr("kMinAreaRectangle")));
}

}  // namespace
}  // namespace lightfit
