#include "render/clearance.h"

#include <gtest/gtest.h>

#include "tests/render/testing.h"

namespace lightfit {
namespace {

using testing::Random;

TEST(DistanceToTriangle, IsThatOfTheNearestOfManyPoints) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d a = random.InCube(1), b = random.InCube(1), c = random.InCube(1);
    const Eigen::Vector3d point = random.InCube(2);
    double nearest = 1e300;
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        const Eigen::Vector3d on = a + (b - a) * u / kSteps + (c - a) * v / kSteps;
        nearest = std::min(nearest, (point - on).norm());
      }
    }
    const double distance = DistanceToTriangle(point, a, b, c);
    EXPECT_LE(distance, nearest + 1e-12);
    // Steps are at most 2 sqrt(3) / 60 long; the grid misses the nearest point by half of that.
    EXPECT_GE(distance, nearest - 0.04);
  }
}

TEST(DistanceToTriangle, IsExactAboveInsideEdgesAndCorners) {
  const Eigen::Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({1, 1, -3}, a, b, c), 3.0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({1, 1, 0}, a, b, c), 0.0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({2, -3, 4}, a, b, c), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({7, 0, 4}, a, b, c), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({-3, -4, 0}, a, b, c), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToTriangle({3, 4, 0}, a, a, a), 5.0);
}

TEST(Clearance, IsTheLeastOverAllTriangles) {
  Random random(12);
  const RayCaster caster = testing::Caster(testing::RandomTriangles(random, 20000, 10.0));
  const Scene& scene = caster.scene();
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d point = random.InCube(8.0);
    double nearest = 1e300;
    for (const Eigen::Vector3i& t : scene.triangles) {
      nearest = std::min(nearest,
                         DistanceToTriangle(point,
                                            scene.vertices[t[0]].cast<double>(),
                                            scene.vertices[t[1]].cast<double>(),
                                            scene.vertices[t[2]].cast<double>()));
    }
    EXPECT_EQ(Clearance(caster, point), nearest);
  }
}

}  // namespace
}  // namespace lightfit
