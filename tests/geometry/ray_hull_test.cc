#include "geometry/ray_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/exact_sum.h"
#include "geometry/convex_hull.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;
using Rays = std::vector<Eigen::Vector3d>;

// Rays around the z axis; on a coarse grid many lie on lines, or in one direction.
Rays RandomRays(Random& random, int count, bool on_grid) {
  Rays rays;
  for (int i = 0; i < count; ++i) {
    if (on_grid) {
      const double length = random.Int(1, 2);
      rays.push_back(length * Eigen::Vector3d(random.Int(-3, 3), random.Int(-3, 3), 4.0));
    } else {
      rays.push_back(
          Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), 1.0).normalized());
    }
  }
  return rays;
}

void Shuffle(Random& random, Rays* rays) {
  for (size_t j = rays->size(); j > 1; --j) {
    std::swap((*rays)[j - 1], (*rays)[random.Int(0, static_cast<int>(j) - 1)]);
  }
}

// Brute force: a ray is extreme when some pair's plane through it has all others on one side, and
// it is not between two rays of that plane.
TEST(ExtremeRays, HasAllRaysInsideAndOnlyCorners) {
  Random random(111);
  for (int i = 0; i < 300; ++i) {
    const Rays rays = RandomRays(random, random.Int(3, 40), i % 2 == 0);
    const std::optional<Rays> hull = ExtremeRays(rays);
    ASSERT_TRUE(hull.has_value());
    if (hull->size() < 3) continue;
    for (size_t k = 0; k < hull->size(); ++k) {
      const Eigen::Vector3d& a = (*hull)[k];
      const Eigen::Vector3d& b = (*hull)[(k + 1) % hull->size()];
      EXPECT_NE(std::find(rays.begin(), rays.end(), a), rays.end());
      // Strictly convex, and nothing beyond any face.
      EXPECT_EQ(OrientationOfRays(a, b, (*hull)[(k + 2) % hull->size()]), 1);
      for (const Eigen::Vector3d& ray : rays) EXPECT_GE(OrientationOfRays(a, b, ray), 0);
    }
  }
}

TEST(ExtremeRays, EqualsThePlanarHullOfGeneralRays) {
  Random random(112);
  for (int i = 0; i < 100; ++i) {
    const Rays rays = RandomRays(random, 30, false);
    std::vector<Eigen::Vector2d> points;
    points.reserve(rays.size());
    for (const Eigen::Vector3d& ray : rays) points.push_back(ray.hnormalized());
    EXPECT_EQ(ExtremeRays(rays)->size(), ConvexHull(points).size());
  }
}

TEST(ExtremeRays, OfHullsAreThoseOfTheUnionToTheLastBit) {
  Random random(113);
  for (int i = 0; i < 400; ++i) {
    Rays rays = RandomRays(random, random.Int(2, 30), i % 2 == 0);
    const Rays expected = *ExtremeRays(rays);
    Shuffle(random, &rays);
    EXPECT_EQ(*ExtremeRays(rays), expected);
    const auto middle = rays.begin() + random.Int(0, static_cast<int>(rays.size()));
    Rays both = *ExtremeRays({rays.begin(), middle});
    const Rays second = *ExtremeRays({middle, rays.end()});
    both.insert(both.end(), second.begin(), second.end());
    EXPECT_EQ(*ExtremeRays(both), expected);
  }
}

TEST(ExtremeRays, SaysWhenTheySurroundTheOrigin) {
  Random random(114);
  for (int i = 0; i < 200; ++i) {
    Rays rays = RandomRays(random, 10, i % 2 == 0);
    if (ExtremeRays(rays)->size() < 3) continue;
    // The opposite of a ray inside the cone, or on its border.
    rays.push_back(i % 3 == 0 ? Eigen::Vector3d(-rays[0])
                              : Eigen::Vector3d(-rays[0] - rays[1] - rays[2]));
    Shuffle(random, &rays);
    EXPECT_FALSE(ExtremeRays(rays).has_value());
  }
}

TEST(ExtremeRays, KeepsRaysOfOnePlane) {
  EXPECT_TRUE(ExtremeRays({})->empty());
  const Eigen::Vector3d a(1, 0, 1), b(2, 0, 1), c(0, -0.0, 1);
  EXPECT_EQ(*ExtremeRays({b, a, c, a}), (Rays{Eigen::Vector3d(0, 0, 1), a, b}));
}

}  // namespace
}  // namespace lightfit
