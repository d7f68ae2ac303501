#include "geometry/convex_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::MatrixNear;
using testing::Random;

constexpr int kNumCases = 1000;  // of each property

// Points on a small grid: repeats and collinear runs are common, and arithmetic is exact.
std::vector<Eigen::Vector2d> GridPoints(Random& random, int max_count, int extent) {
  std::vector<Eigen::Vector2d> points(random.Int(0, max_count));
  for (Eigen::Vector2d& point : points) {
    point.x() = random.Int(-extent, extent);
    point.y() = random.Int(-extent, extent);
  }
  return points;
}

// By definition: a point is a hull vertex unless it lies in a triangle or on a segment of others.
bool IsExtreme(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& points) {
  // Extreme exactly if all directions to the other points fit in an open half plane.
  std::vector<Eigen::Vector2d> directions;
  for (const Eigen::Vector2d& other : points) {
    if (other != point) directions.push_back(other - point);
  }
  if (directions.empty()) return true;
  for (const Eigen::Vector2d& first : directions) {
    const bool all_left = std::all_of(directions.begin(), directions.end(), [&](const auto& d) {
      return Cross(first, d) > 0.0 || (Cross(first, d) == 0.0 && first.dot(d) > 0.0);
    });
    if (all_left) return true;
  }
  return false;
}

bool Contains(absl::Span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& point) {
  return std::find(polygon.begin(), polygon.end(), point) != polygon.end();
}

TEST(ConvexHull, KeepsExactlyTheExtremePoints) {
  Random random(71);
  for (int i = 0; i < kNumCases; ++i) {
    const std::vector<Eigen::Vector2d> points = GridPoints(random, 30, 6);
    const Polygon hull = ConvexHull(points);
    for (const Eigen::Vector2d& point : points) {
      ASSERT_TRUE(Contains(hull, point) == IsExtreme(point, points));
    }
    for (const Eigen::Vector2d& vertex : hull) ASSERT_TRUE(Contains(points, vertex));
  }
}

TEST(ConvexHull, IsStrictlyCounterClockwise) {
  Random random(72);
  for (int i = 0; i < kNumCases; ++i) {
    const Polygon hull = ConvexHull(GridPoints(random, 60, 20));
    const size_t n = hull.size();
    for (size_t k = 0; n >= 3 && k < n; ++k) {
      const Eigen::Vector2d& a = hull[k];
      const Eigen::Vector2d& b = hull[(k + 1) % n];
      ASSERT_TRUE(Cross(b - a, hull[(k + 2) % n] - b) > 0.0);
      for (const Eigen::Vector2d& vertex : hull) ASSERT_TRUE(Cross(b - a, vertex - a) >= 0.0);
    }
  }
}

TEST(ConvexHull, DoesNotDependOnTheOrderOfPoints) {
  Random random(73);
  for (int i = 0; i < kNumCases; ++i) {
    std::vector<Eigen::Vector2d> points = GridPoints(random, 30, 10);
    const Polygon hull = ConvexHull(points);
    std::reverse(points.begin(), points.end());
    ASSERT_TRUE(ConvexHull(points) == hull);
    ASSERT_TRUE(ConvexHull(hull) == hull);
  }
}

TEST(ConvexHull, EnclosesRandomPointsToRounding) {
  Random random(51);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix2d stretch = random.LogUniform(1e-6, 1e6) * random.Matrix2(1e4);
    std::vector<Eigen::Vector2d> points;
    for (int k = 0; k < 200; ++k) points.push_back(stretch * random.InCube(1.0).head<2>());
    const Polygon hull = ConvexHull(points);
    ASSERT_GE(hull.size(), 3u);
    for (size_t k = 0; k < hull.size(); ++k) {
      const Eigen::Vector2d edge = hull[(k + 1) % hull.size()] - hull[k];
      for (const Eigen::Vector2d& point : points) {
        EXPECT_GE(Cross(edge, point - hull[k]), -1e-14 * edge.norm() * stretch.norm());
      }
    }
  }
}

TEST(ConvexHull, DegenerateInputs) {
  EXPECT_TRUE(ConvexHull({}).empty());
  EXPECT_EQ(ConvexHull({{1.0, 2.0}, {1.0, 2.0}}), (Polygon{{1.0, 2.0}}));
  EXPECT_EQ(ConvexHull({{2.0, 2.0}, {0.0, 0.0}, {1.0, 1.0}, {0.0, 0.0}}),
            (Polygon{{0.0, 0.0}, {2.0, 2.0}}));
}

TEST(Area, OfKnownShapes) {
  EXPECT_DOUBLE_EQ(Area(Polygon{{0, 0}, {4, 0}, {4, 3}, {0, 3}}), 12.0);
  EXPECT_DOUBLE_EQ(Area(Polygon{{0, 0}, {0, 3}, {4, 0}}), -6.0);  // clockwise
  EXPECT_EQ(Area(Polygon{}), 0.0);
  EXPECT_EQ(Area(Polygon{{1, 1}, {2, 5}}), 0.0);
}

TEST(Centroid, OfKnownShapes) {
  EXPECT_THAT(Centroid({{0, 0}, {4, 0}, {4, 2}, {0, 2}}),
              MatrixNear(Eigen::Vector2d(2.0, 1.0), 1e-15));
  EXPECT_THAT(Centroid({{0, 0}, {3, 0}, {0, 3}}), MatrixNear(Eigen::Vector2d(1.0, 1.0), 1e-15));
  EXPECT_EQ(Centroid({}), Eigen::Vector2d(0.0, 0.0));
  EXPECT_THAT(Centroid({{1, 1}, {3, 5}}), MatrixNear(Eigen::Vector2d(2.0, 3.0), 1e-15));
}

// By slicing: the centroid of a convex polygon from many thin horizontal strips.
TEST(Centroid, EqualsSlicedIntegral) {
  Random random(52);
  for (int i = 0; i < 20; ++i) {
    const Polygon polygon = testing::RandomPolygon(random, 12, 10.0);
    double y_min = 1e300, y_max = -1e300;
    for (const Eigen::Vector2d& v : polygon) {
      y_min = std::min(y_min, v.y());
      y_max = std::max(y_max, v.y());
    }
    constexpr int kSlices = 20000;
    double area = 0.0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int slice = 0; slice < kSlices; ++slice) {
      const double y = y_min + (y_max - y_min) * (slice + 0.5) / kSlices;
      double x_min = 1e300, x_max = -1e300;
      for (size_t k = 0; k < polygon.size(); ++k) {
        const Eigen::Vector2d& a = polygon[k];
        const Eigen::Vector2d& b = polygon[(k + 1) % polygon.size()];
        if ((a.y() - y) * (b.y() - y) >= 0.0) continue;
        const double x = a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y());
        x_min = std::min(x_min, x);
        x_max = std::max(x_max, x);
      }
      if (x_max <= x_min) continue;
      area += x_max - x_min;
      sum += (x_max - x_min) * Eigen::Vector2d(0.5 * (x_min + x_max), y);
    }
    EXPECT_THAT(Centroid(polygon), MatrixNear(Eigen::Vector2d(sum / area), 1e-6));
    EXPECT_NEAR(Area(polygon), area * (y_max - y_min) / kSlices, 1e-6);
  }
}

Polygon BuiltHull(const std::vector<Eigen::Vector2d>& points) {
  ConvexHullBuilder builder;
  for (const Eigen::Vector2d& point : points) builder.Add(point);
  return builder.Hull();
}

TEST(ConvexHullBuilder, BuildsTheHullOfAllPointsAtOnce) {
  Random random(42);
  for (const int count : {0, 1, 2, 3, 10, 1000, 5000, 50000}) {
    // Repeats and collinear runs, where arithmetic is exact; a cloud; a ray of points outwards.
    std::vector<Eigen::Vector2d> grid, cloud, spiral;
    for (int i = 0; i < count; ++i) {
      grid.emplace_back(random.Int(-30, 30), random.Int(-20, 20));
      cloud.push_back(random.InCube(1.0).head<2>());
      const double angle = 0.7 * i, radius = 1.0 + 0.001 * i;
      spiral.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    for (const auto& points : {grid, cloud, spiral}) {
      EXPECT_EQ(BuiltHull(points), ConvexHull(points)) << count;
    }
  }
}

// More vertices than there are places for.
TEST(ConvexHullBuilder, KeepsEveryPointOfACircle) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 30000; ++i) {
    const double angle = 2.0 * M_PI * (i * 7919 % 30000) / 30000.0;
    points.emplace_back(std::cos(angle), std::sin(angle));
  }
  const Polygon hull = BuiltHull(points);
  EXPECT_EQ(hull.size(), points.size());
  EXPECT_EQ(hull, ConvexHull(points));
}

}  // namespace
}  // namespace lightfit
