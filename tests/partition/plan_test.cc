#include "partition/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/partition/random_plan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::RandomPlan;
using testing::RandomPlanLight;
using testing::RandomPlanMap;
using testing::StatusIs;

Eigen::Vector2d TexelOf(const PlanMap& map, const Eigen::Vector3d& world) {
  const Eigen::Vector4d at = map.map_from_world * world.homogeneous();
  return at.head<2>() / at.w();
}

// Texels per area of a plane through the point, by central differences.
double DensityByDifferences(const PlanMap& map,
                            const Eigen::Vector3d& world,
                            const Eigen::Vector3d& side,
                            const Eigen::Vector3d& other_side) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix2d jacobian;
  jacobian.col(0) = TexelOf(map, world + kStep * side) - TexelOf(map, world - kStep * side);
  jacobian.col(1) =
      TexelOf(map, world + kStep * other_side) - TexelOf(map, world - kStep * other_side);
  return std::abs(jacobian.determinant()) / (4.0 * kStep * kStep);
}

TEST(PlanLookUp, AsksTheDensestMapThatHoldsTheReceiverOnWhateverSurface) {
  // Differences tell maps apart that are not within a thousandth of one another.
  constexpr double kTolerance = 1e-3;
  int num_places = 0, num_none = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    const Plan plan = RandomPlan(light, random);
    const auto look_up = PlanLookUp::Create(plan, light);
    ASSERT_THAT(look_up, IsOk());
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d world = random.InCube(4.0);
      const Eigen::Vector3d side = random.UnitVector();
      const Eigen::Vector3d other_side = random.UnitVector();
      double most = 0.0;
      for (const PlanMap& map : plan.maps) {
        const Eigen::Vector4d at = map.map_from_world * world.homogeneous();
        const Eigen::Vector2d uv = at.head<2>() / at.w();
        if (!(at.w() > 0.0) || uv.x() < 0.0 || uv.y() < 0.0 || uv.x() >= map.size.width ||
            uv.y() >= map.size.height) {
          continue;
        }
        most = std::max(most, DensityByDifferences(map, world, side, other_side));
      }
      const PlanPlace place = look_up->At(world);
      if (place.map < 0) {
        EXPECT_EQ(most, 0.0);
        ++num_none;
        continue;
      }
      ++num_places;
      EXPECT_THAT(place.texel, testing::MatrixNear(TexelOf(plan.maps[place.map], world), 1e-6));
      const double density = DensityByDifferences(plan.maps[place.map], world, side, other_side);
      EXPECT_GE(density, (1.0 - kTolerance) * most);
    }
  }
  EXPECT_GT(num_places, 1000);
  EXPECT_GT(num_none, 100);
}

// math.md (19): texels per screen area are |V| / q^3, with V the receiver's own.
TEST(PlanLookUp, CoarsenessIsTheCubeRootOfAreaUpToTheReceiversOwnFactor) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    Plan plan;
    plan.maps = {RandomPlanMap(light, random), RandomPlanMap(light, random)};
    const auto look_up = PlanLookUp::Create(plan, light);
    ASSERT_THAT(look_up, IsOk());
    int num_compared = 0;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d world = random.InCube(4.0);
      const Eigen::Vector3d side = random.UnitVector();
      const Eigen::Vector3d other_side = random.UnitVector();
      const double q[2] = {look_up->CoarsenessOf(0, world), look_up->CoarsenessOf(1, world)};
      if (!(q[0] > 0.01 && q[1] > 0.01)) continue;
      const double ratio = DensityByDifferences(plan.maps[0], world, side, other_side) /
                           DensityByDifferences(plan.maps[1], world, side, other_side);
      const double foretold = std::pow(q[1] / q[0], 3.0);
      EXPECT_NEAR(ratio / foretold, 1.0, 1e-3) << q[0] << " " << q[1];
      ++num_compared;
    }
    if (light.kind == Light::Kind::kDirectional) {
      EXPECT_GT(num_compared, 10);
    }
  }
}

TEST(PlanLookUp, GuardKeepsAFilterInTheMap) {
  Random random(7);
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  Plan plan;
  plan.maps = {RandomPlanMap(light, random)};
  const auto look_up = PlanLookUp::Create(plan, light, 3.0);
  ASSERT_THAT(look_up, IsOk());
  int num_inside = 0, num_kept_out = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d world = random.InCube(2.0);
    const Eigen::Vector2d uv = TexelOf(plan.maps[0], world);
    const MapSize size = plan.maps[0].size;
    const auto within = [&](double guard) {
      return uv.x() >= guard && uv.y() >= guard && uv.x() < size.width - guard &&
             uv.y() < size.height - guard;
    };
    EXPECT_EQ(look_up->At(world).map, within(3.0) ? 0 : -1);
    num_inside += within(3.0) ? 1 : 0;
    num_kept_out += within(0.0) && !within(3.0) ? 1 : 0;
  }
  EXPECT_GT(num_inside, 10);
  EXPECT_GT(num_kept_out, 1);
}

TEST(PlanLookUp, HalfSpacesSayWhoMayAsk) {
  Random random(8);
  const Light light = Light::Directional("sun", {0.3, -0.2, -1.0});
  Plan plan;
  plan.maps = {RandomPlanMap(light, random), RandomPlanMap(light, random)};
  plan.maps[1].map_from_world = plan.maps[0].map_from_world;
  plan.maps[1].size = plan.maps[0].size;
  const Eigen::RowVector4d upper(0.0, 1.0, 0.0, -0.1);
  plan.maps[0].half_spaces = {upper};
  plan.maps[1].half_spaces = {-upper};
  const auto look_up = PlanLookUp::Create(plan, light);
  ASSERT_THAT(look_up, IsOk());
  int num_asked[2] = {0, 0};
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d world = random.InCube(1.0);
    const PlanPlace place = look_up->At(world);
    if (place.map < 0) continue;
    EXPECT_EQ(place.map, world.y() >= 0.1 ? 0 : 1);
    ++num_asked[place.map];
  }
  EXPECT_GT(num_asked[0], 10);
  EXPECT_GT(num_asked[1], 10);
}

TEST(PlanLookUp, SaysWhatIsWrongWithAPlan) {
  Random random(9);
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  EXPECT_THAT(PlanLookUp::Create(Plan(), light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("0 maps, want 1 ... 32")));
  Plan plan;
  plan.maps.assign(kMaxPlanMaps + 1, RandomPlanMap(light, random));
  EXPECT_THAT(PlanLookUp::Create(plan, light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("33 maps")));
  plan.maps.resize(1);
  EXPECT_THAT(PlanLookUp::Create(plan, light, 500.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin")));
  plan.maps[0].map_from_world.setZero();
  EXPECT_THAT(PlanLookUp::Create(plan, light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sun")));
}

TEST(NumTexels, IsThatOfAllMaps) {
  Plan plan;
  plan.maps.resize(2);
  plan.maps[0].size = {100, 50};
  plan.maps[1].size = {65536, 65536};
  EXPECT_EQ(NumTexels(plan), 5000 + (int64_t{1} << 32));
}

}  // namespace
}  // namespace lightfit
