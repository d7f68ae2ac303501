#include "geometry/polar_of_difference.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;
using testing::RandomPolygon;

constexpr double kRounding = 1e-9;  // of slivers up to a hundred times as long as wide

// From one side of the strip to the other.
double Width(const Polygon& polygon, const Eigen::Vector2d& normal) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector2d& point : polygon) {
    low = std::min(low, normal.dot(point));
    high = std::max(high, normal.dot(point));
  }
  return high - low;
}

// Every row is that of a strip that fits, along an edge, and the pair after it is touched from
// there to the next.
TEST(PolarOfDifference, IsMadeOfTheStripsAlongEdges) {
  Random random(191);
  for (int i = 0; i < 200; ++i) {
    const Polygon polygon = RandomPolygon(random, 3 + i % 30, 100.0);
    const ScratchVector<PolarBreakpoint> polar = PolarOfDifference(polygon);
    const size_t n = polar.size();
    ASSERT_GE(n, 2u);
    ASSERT_LE(n, polygon.size());
    for (size_t k = 0; k < n; ++k) {
      const PolarBreakpoint& here = polar[k];
      const Eigen::Vector2d next = k + 1 == n ? Eigen::Vector2d(-polar[0].row) : polar[k + 1].row;
      EXPECT_NEAR(Width(polygon, here.row), 1.0, kRounding);
      EXPECT_EQ(here.pair, polygon[here.high] - polygon[here.low]);
      EXPECT_NEAR(here.pair.dot(here.row), 1.0, kRounding);
      EXPECT_NEAR(here.pair.dot(next), 1.0, kRounding);
      EXPECT_GT(Cross(here.row, next), 0.0);
    }
  }
}

// In any direction the boundary is as far away as one over the width there.
TEST(PolarOfDifference, IsAsFarAsOneOverTheWidthInEveryDirection) {
  Random random(192);
  for (int i = 0; i < 100; ++i) {
    const Polygon polygon = RandomPolygon(random, 3 + i % 30, 100.0);
    const ScratchVector<PolarBreakpoint> polar = PolarOfDifference(polygon);
    for (int direction = 0; direction < 50; ++direction) {
      const double angle = M_PI * direction / 50.0;
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      // Of all touched pairs the one that reaches furthest along the normal.
      double width = 0.0;
      for (const PolarBreakpoint& breakpoint : polar) {
        width = std::max(width, std::abs(breakpoint.pair.dot(normal)));
      }
      const double wanted = Width(polygon, normal);
      EXPECT_NEAR(width, wanted, kRounding * wanted);
    }
  }
}

}  // namespace
}  // namespace lightfit
