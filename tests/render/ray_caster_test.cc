#include "render/ray_caster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::AllHits;
using testing::BruteHits;
using ::testing::HasSubstr;
using testing::Random;
using testing::StatusIs;

// Casts rays from `distance` scene sizes away and compares with brute force. Where the ray passes
// within 1e-4 of a triangle's edge, rounding may decide otherwise.
void CompareWithBruteForce(uint64_t seed, double distance) {
  Random random(seed);
  constexpr double kSize = 10.0;
  const RayCaster caster = testing::Caster(testing::RandomTriangles(random, 300, kSize));
  int num_hits = 0, num_compared = 0;
  for (int i = 0; i < 1500; ++i) {
    Ray ray;
    ray.origin = distance * kSize * random.UnitVector();
    ray.direction = (random.InCube(0.4 * kSize) - ray.origin).normalized();
    const BruteHits expected = AllHits(caster.scene(), ray);
    if (expected.near_an_edge) continue;
    ++num_compared;
    const Hit hit = caster.FirstHit(ray);
    EXPECT_EQ(caster.IsBlocked(ray), !expected.distances.empty());
    ASSERT_EQ(hit.is_surface(), !expected.distances.empty());
    if (!hit.is_surface()) continue;
    ++num_hits;
    EXPECT_EQ(hit.triangle, expected.first);
    EXPECT_NEAR(hit.distance, expected.distances[0], 1e-9 * (1.0 + expected.distances[0]));
    // The next hit, and whether it is in the way.
    const double behind = hit.distance + 1e-3;
    const double next = expected.distances.size() > 1 ? expected.distances[1] : 1e300;
    if (std::abs(next - behind) < 2e-3) continue;
    EXPECT_EQ(caster.IsBlocked(ray, behind), next < 1e300);
    EXPECT_FALSE(caster.IsBlocked(ray, 0.0, hit.distance - 1e-3));
    if (next < 1e300) {
      EXPECT_NEAR(caster.FirstHit(ray, behind).distance, next, 1e-9 * (1.0 + next));
    }
  }
  EXPECT_GT(num_compared, 1000);
  EXPECT_GT(num_hits, 500);
}

TEST(RayCaster, AgreesWithBruteForce) { CompareWithBruteForce(21, 0.5); }
TEST(RayCaster, AgreesWithBruteForceFromFarAway) { CompareWithBruteForce(22, 30.0); }
TEST(RayCaster, AgreesWithBruteForceFromVeryFarAway) { CompareWithBruteForce(23, 1e4); }

TEST(RayCaster, RaysThatMissTheBoxHitNothing) {
  Scene scene;
  testing::AddFloor(1.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 1, 0)}) {
    EXPECT_FALSE(caster.FirstHit({{0, 0, 5}, direction}).is_surface());
    EXPECT_FALSE(caster.IsBlocked({{0, 0, 5}, direction}));
  }
  const Ray down = {{0, 0, 5}, {0, 0, -1}};
  EXPECT_DOUBLE_EQ(caster.FirstHit(down).distance, 5.0);
  EXPECT_FALSE(caster.FirstHit(down, 0.0, 4.9).is_surface());
  EXPECT_FALSE(caster.FirstHit(down, 5.1).is_surface());
  EXPECT_TRUE(caster.FirstHit(down, 4.9, 5.1).is_surface());
}

TEST(RayCaster, DropsBadTrianglesAndCountsThem) {
  Scene scene;
  testing::AddFloor(1.0, &scene);
  scene.triangles.emplace_back(0, 0, 1);
  scene.triangles.emplace_back(0, 1, 1000);
  const RayCaster caster = testing::Caster(scene);
  EXPECT_EQ(caster.num_dropped_triangles(), 2);
  EXPECT_EQ(caster.scene().triangles.size(), 2u);
  EXPECT_EQ(caster.bounds().max(), Eigen::Vector3d(1, 1, 0));
  EXPECT_NEAR(std::abs(caster.Normal(0).z()), 1.0, 1e-15);
}

TEST(RayCaster, RefusesScenesWithoutArea) {
  Scene scene;
  EXPECT_THAT(RayCaster::Build(scene).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("no triangle")));
  testing::AddTriangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}, &scene);
  EXPECT_THAT(RayCaster::Build(scene).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("1 without")));
}

TEST(RayCaster, ResolutionGrowsWithTheScene) {
  Scene small, large;
  testing::AddFloor(1.0, &small);
  testing::AddFloor(1000.0, &large);
  const double fine = testing::Caster(small).Resolution({0, 0, 0});
  const double coarse = testing::Caster(large).Resolution({0, 0, 0});
  EXPECT_GT(fine, 1e-8);
  EXPECT_LT(fine, 1e-5);
  EXPECT_NEAR(coarse / fine, 1000.0, 1e-6);
}

}  // namespace
}  // namespace lightfit
