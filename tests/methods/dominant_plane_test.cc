#include "methods/dominant_plane.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::Random;
using Plane = Eigen::Hyperplane<double, 3>;

struct Cloud {
  std::vector<Eigen::Vector3d> points, normals;

  void AddPlane(Random& random,
                const Plane& plane,
                const Eigen::Vector3d& centre,
                double size,
                int count,
                double noise) {
    const Eigen::Vector3d right = plane.normal().unitOrthogonal();
    const Eigen::Vector3d up = plane.normal().cross(right);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d point =
          centre + random.Uniform(-size, size) * right + random.Uniform(-size, size) * up;
      points.push_back(plane.projection(point) +
                       noise * size * random.Uniform(-1.0, 1.0) * plane.normal());
      normals.push_back((plane.normal() + noise * random.InCube(1.0)).normalized());
    }
  }
};

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(DominantPlane, FindsTheLargestOfThreeAmongClutter) {
  Random random(61);
  for (int i = 0; i < 100; ++i) {
    const double size = random.LogUniform(1e-2, 1e3);
    const Eigen::Vector3d centre = 5.0 * random.InCube(size);
    Cloud cloud;
    const Plane best(random.UnitVector(), centre + random.InCube(0.3 * size));
    cloud.AddPlane(random, best, centre, size, 900, 1e-3);
    for (int k = 0; k < 2; ++k) {
      const Plane other(random.UnitVector(), centre + random.InCube(0.5 * size));
      cloud.AddPlane(random, other, centre, size, 450, 1e-3);
    }
    for (int k = 0; k < 700; ++k) {
      cloud.points.push_back(centre + random.InCube(size));
      cloud.normals.push_back(random.UnitVector());
    }
    const std::optional<Plane> found = DominantPlane(cloud.points, cloud.normals);
    ASSERT_TRUE(found.has_value());
    EXPECT_LE(AngleBetween(found->normal(), best.normal()), 2e-3) << i;
    EXPECT_LE(found->absDistance(best.projection(centre)), 3e-3 * size) << i;
  }
}

// Without noise the fit is exact, whatever the bins' borders.
TEST(DominantPlane, IsExactOnAPlane) {
  Random random(62);
  for (int i = 0; i < 200; ++i) {
    const double size = random.LogUniform(1e-2, 1e3);
    const Plane plane(random.UnitVector(), random.InCube(3.0 * size));
    Cloud cloud;
    cloud.AddPlane(random, plane, Eigen::Vector3d::Zero(), size, 60, 0.0);
    const std::optional<Plane> found = DominantPlane(cloud.points, cloud.normals);
    ASSERT_TRUE(found.has_value());
    EXPECT_LE(AngleBetween(found->normal(), plane.normal()), 1e-7);
    EXPECT_LE(found->absDistance(cloud.points[0]), 1e-9 * size);
  }
}

// Two storeys: parallel planes, the fuller one wins, not their mean.
TEST(DominantPlane, TellsParallelPlanesApart) {
  Random random(63);
  Cloud cloud;
  const Plane floor(Eigen::Vector3d::UnitY(), Eigen::Vector3d::Zero());
  const Plane upper(Eigen::Vector3d::UnitY(), Eigen::Vector3d(0.0, 0.3, 0.0));
  cloud.AddPlane(random, floor, Eigen::Vector3d::Zero(), 5.0, 300, 0.0);
  cloud.AddPlane(random, upper, Eigen::Vector3d::Zero(), 5.0, 320, 0.0);
  const std::optional<Plane> found = DominantPlane(cloud.points, cloud.normals);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->offset(), -0.3, 1e-9);
}

// The two sides of a thin wall are two planes.
TEST(DominantPlane, KeepsTheSideOfItsNormals) {
  Random random(64);
  Cloud cloud;
  const Plane front(Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  const Plane back(-Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  cloud.AddPlane(random, front, Eigen::Vector3d::Zero(), 1.0, 100, 0.0);
  cloud.AddPlane(random, back, Eigen::Vector3d::Zero(), 1.0, 150, 0.0);
  const std::optional<Plane> found = DominantPlane(cloud.points, cloud.normals);
  ASSERT_TRUE(found.has_value());
  EXPECT_LE((found->normal() + Eigen::Vector3d::UnitX()).norm(), 1e-9);
}

TEST(DominantPlane, RepeatsTheSameBits) {
  Random random(65);
  Cloud cloud;
  for (int k = 0; k < 3; ++k) {
    cloud.AddPlane(random, Plane(random.UnitVector(), 0.1), Eigen::Vector3d::Zero(), 1, 200, 0.01);
  }
  EXPECT_EQ(DominantPlane(cloud.points, cloud.normals)->coeffs(),
            DominantPlane(cloud.points, cloud.normals)->coeffs());
}

TEST(DominantPlane, BadInputGivesNothing) {
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::nan("")), up(0, 1, 0);
  EXPECT_FALSE(DominantPlane({}, {}).has_value());
  EXPECT_FALSE(DominantPlane({up}, {up}).has_value());
  const std::vector<Eigen::Vector3d> same(10, up), bad(10, nan);
  EXPECT_FALSE(DominantPlane(same, same).has_value());
  EXPECT_FALSE(DominantPlane(bad, same).has_value());
  EXPECT_FALSE(DominantPlane(same, bad).has_value());
  Random random(66);
  Cloud cloud;
  cloud.AddPlane(random, Plane(up, 0.0), Eigen::Vector3d::Zero(), 1.0, 50, 0.0);
  DominantPlaneOptions options;
  options.max_distance = std::nan("");
  EXPECT_FALSE(DominantPlane(cloud.points, cloud.normals, options).has_value());
  options = {};
  options.max_angle_rad = 0.0;
  EXPECT_FALSE(DominantPlane(cloud.points, cloud.normals, options).has_value());
}

// Clutter alone has no plane that a share of it lies on.
TEST(DominantPlane, ClutterHasNone) {
  Random random(67);
  Cloud cloud;
  for (int k = 0; k < 3000; ++k) {
    cloud.points.push_back(random.InCube(1.0));
    cloud.normals.push_back(random.UnitVector());
  }
  EXPECT_FALSE(DominantPlane(cloud.points, cloud.normals).has_value());
}

}  // namespace
}  // namespace lightfit
