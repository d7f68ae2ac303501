#include "geometry/hull_interior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/convex_hull.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;

bool IsInside(const Polygon& polygon, const Eigen::Vector2d& point) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (!(Cross(edge, point - polygon[i]) > 0.0)) return false;
  }
  return polygon.size() >= 3;
}

// Never true outside, and true for all but a thin rim inside.
TEST(HullInterior, TrueOnlyInsideAndMissesOnlyTheRim) {
  Random random(161);
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<Eigen::Vector2d> points;
    const int count = 3 + repeat % 40;
    const double flatness = random.LogUniform(1e-4, 1.0);
    for (int i = 0; i < count; ++i) {
      points.emplace_back(random.Uniform(-1.0, 1.0), flatness * random.Uniform(-1.0, 1.0));
    }
    const Polygon polygon = ConvexHull(points);
    const Eigen::Vector2d centre = Centroid(polygon);
    const HullInterior inside(polygon);
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector2d point(random.Uniform(-1.1, 1.1), flatness * random.Uniform(-1.1, 1.1));
      if (inside(point)) {
        EXPECT_TRUE(IsInside(polygon, point)) << "polygon " << repeat;
      }
      const Eigen::Vector2d outwards = centre + 1.15 * (point - centre);
      if (IsInside(polygon, outwards)) {
        EXPECT_TRUE(inside(point)) << "polygon " << repeat;
      }
    }
  }
}

TEST(HullInterior, NothingIsInsideWithoutArea) {
  for (const Polygon& polygon : {Polygon{}, Polygon{{1.0, 2.0}}, Polygon{{0.0, 0.0}, {2.0, 0.0}}}) {
    EXPECT_FALSE(HullInterior(polygon)({1.0, 0.0}));
    EXPECT_FALSE(HullInterior(polygon)({1.0, 2.0}));
  }
}

TEST(HullInterior, NanIsNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const HullInterior inside({{-1.0, -1.0}, {1.0, -1.0}, {0.0, 2.0}});
  EXPECT_TRUE(inside({0.0, 0.0}));
  EXPECT_FALSE(inside({nan, 0.0}));
  EXPECT_FALSE(inside({0.0, nan}));
}

}  // namespace
}  // namespace lightfit
