#include "partition/published/trapezoid.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

// Points with the least b at 0, of any proportions.
std::vector<Eigen::Vector2d> RandomPoints(Random& random) {
  const double width = random.LogUniform(1e-3, 1e3), length = random.LogUniform(1e-3, 1e3);
  const double lean = random.Uniform(-1.0, 1.0);
  const bool is_frustum = random.Coin();  // narrow where it begins
  std::vector<Eigen::Vector2d> points;
  for (int i = random.Int(3, 24); i > 0; --i) {
    const double b = random.Uniform(0.0, 1.0);
    const double reach = is_frustum ? 0.05 + b : 1.0;
    points.emplace_back(width * (reach * random.Uniform(-1.0, 1.0) + lean * b), length * b);
  }
  double least = points[0].y();
  for (const Eigen::Vector2d& point : points) least = std::min(least, point.y());
  for (Eigen::Vector2d& point : points) point.y() -= least;
  return points;
}

double LengthOf(const std::vector<Eigen::Vector2d>& points) {
  double length = 0.0;
  for (const Eigen::Vector2d& point : points) length = std::max(length, point.y());
  return length;
}

// The tightest base for an axis and a slope, from the definition.
double AreaOf(const std::vector<Eigen::Vector2d>& points, double centre, double slope) {
  double base = 0.0;
  for (const Eigen::Vector2d& point : points) {
    base = std::max(base, 2.0 * (std::abs(point.x() - centre) - slope * point.y()));
  }
  const double length = LengthOf(points);
  return length * (base + slope * length);
}

// The least of a convex function of one variable.
template <typename F>
double LeastOf(double low, double high, const F& f) {
  for (int i = 0; i < 120; ++i) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return f(0.5 * (low + high));
}

TEST(LeastTrapezoid, HoldsAllPoints) {
  constexpr double kRounding = 1e-12;  // of the extent
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const std::vector<Eigen::Vector2d> points = RandomPoints(random);
    const Trapezoid trapezoid = LeastTrapezoid(points);
    EXPECT_GE(trapezoid.base, 0.0);
    EXPECT_GE(trapezoid.slope, 0.0);
    EXPECT_EQ(trapezoid.length, LengthOf(points));
    double extent = trapezoid.WidthAt(trapezoid.length);
    for (const Eigen::Vector2d& point : points) {
      extent = std::max(extent, std::abs(point.x()));
    }
    for (const Eigen::Vector2d& point : points) {
      EXPECT_LE(2.0 * std::abs(point.x() - trapezoid.centre),
                trapezoid.WidthAt(point.y()) + kRounding * extent);
    }
  }
}

// Nested searches of the area, which is convex in axis and slope together.
TEST(LeastTrapezoid, IsTheLeastOfAllAxesAndSlopes) {
  constexpr double kSearch = 1e-9;  // what 120 thirds leave, and rounding
  Random random(2);
  int num_sloped = 0;
  for (int i = 0; i < 12; ++i) {
    const std::vector<Eigen::Vector2d> points = RandomPoints(random);
    double low = points[0].x(), high = low, steepest = 0.0;
    for (const Eigen::Vector2d& point : points) {
      low = std::min(low, point.x());
      high = std::max(high, point.x());
      for (const Eigen::Vector2d& other : points) {
        if (other.y() == point.y()) continue;
        steepest = std::max(steepest, std::abs((other.x() - point.x()) / (other.y() - point.y())));
      }
    }
    const double area = LeastOf(0.0, steepest, [&](double slope) {
      return LeastOf(low, high, [&](double centre) { return AreaOf(points, centre, slope); });
    });
    const Trapezoid trapezoid = LeastTrapezoid(points);
    EXPECT_NEAR(trapezoid.Area() / area, 1.0, kSearch) << "case " << i;
    num_sloped += trapezoid.slope > 0.0 ? 1 : 0;
  }
  EXPECT_GT(num_sloped, 3);
}

// The same against a grid: nothing on it is less.
TEST(LeastTrapezoid, IsBelowAGridOfAxesAndSlopes) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const std::vector<Eigen::Vector2d> points = RandomPoints(random);
    const Trapezoid trapezoid = LeastTrapezoid(points);
    const double reach = trapezoid.WidthAt(trapezoid.length);
    for (int row = 0; row < 60; ++row) {
      const double slope = 0.05 * row * (trapezoid.slope + 0.1 * reach / trapezoid.length);
      for (int column = 0; column < 60; ++column) {
        const double centre = trapezoid.centre + reach * (column - 30) / 60.0;
        EXPECT_LE(trapezoid.Area(), AreaOf(points, centre, slope) * (1.0 + 1e-12));
      }
    }
  }
}

TEST(LeastTrapezoid, OfATrapezoidIsItself) {
  const std::vector<Eigen::Vector2d> points = {{1.0, 0.0}, {3.0, 0.0}, {7.0, 10.0}, {-3.0, 10.0}};
  const Trapezoid trapezoid = LeastTrapezoid(points);
  EXPECT_DOUBLE_EQ(trapezoid.centre, 2.0);
  EXPECT_DOUBLE_EQ(trapezoid.base, 2.0);
  EXPECT_DOUBLE_EQ(trapezoid.slope, 0.4);
  EXPECT_DOUBLE_EQ(trapezoid.length, 10.0);
  EXPECT_DOUBLE_EQ(trapezoid.Area(), 60.0);
}

TEST(LeastTrapezoid, DoesNotNarrowAlongTheAxis) {
  const std::vector<Eigen::Vector2d> points = {{-4.0, 0.0}, {4.0, 0.0}, {1.0, 5.0}, {-1.0, 5.0}};
  const Trapezoid trapezoid = LeastTrapezoid(points);
  EXPECT_EQ(trapezoid.slope, 0.0);
  EXPECT_DOUBLE_EQ(trapezoid.base, 8.0);
}

TEST(LeastTrapezoid, OfATriangleOnItsTipHasNoBase) {
  const std::vector<Eigen::Vector2d> points = {{0.0, 0.0}, {2.0, 4.0}, {-2.0, 4.0}};
  const Trapezoid trapezoid = LeastTrapezoid(points);
  EXPECT_DOUBLE_EQ(trapezoid.slope, 0.5);
  EXPECT_EQ(trapezoid.base, 0.0);
}

}  // namespace
}  // namespace lightfit
