#include "partition/plan_uniforms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/partition/random_plan.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::RandomPlan;
using testing::RandomPlanLight;
using testing::RandomPlanMap;
using testing::RelativeError;
using testing::StatusIs;

// Of one rounding to single precision.
constexpr double kFloatRounding = 0x1p-24;

double Dot(const float (&row)[4], const Eigen::Vector3d& x) {
  return row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3];
}

// The sum of the terms' sizes, in which rounding is measured.
double SizeOf(const float (&row)[4], const Eigen::Vector3d& x) {
  return std::abs(row[0] * x[0]) + std::abs(row[1] * x[1]) + std::abs(row[2] * x[2]) +
         std::abs(row[3]);
}

TEST(PlanUniforms, RowsSizesAndHeadAreThePlans) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    Plan plan = RandomPlan(light, random);
    plan.border = random.Coin() ? Border::kLit : Border::kDark;
    std::vector<Eigen::Vector2i> offsets;
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      offsets.emplace_back(random.Int(0, 4000), random.Int(0, 4000));
    }
    const auto uniforms = MakePlanUniforms(plan, light, 1.5, offsets);
    ASSERT_THAT(uniforms, IsOk());
    ASSERT_EQ(uniforms->num_maps, static_cast<int>(plan.maps.size()));
    EXPECT_EQ(uniforms->guard_texels, 1.5f);
    EXPECT_EQ(uniforms->border_light, plan.border == Border::kLit ? 1.0f : 0.0f);
    EXPECT_EQ(BytesOf(*uniforms), 16 + 96 * plan.maps.size());
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      const PlanMapUniforms& map = uniforms->maps[k];
      EXPECT_EQ(map.size[0], plan.maps[k].size.width);
      EXPECT_EQ(map.size[1], plan.maps[k].size.height);
      EXPECT_EQ(map.atlas_offset[0], offsets[k].x());
      EXPECT_EQ(map.atlas_offset[1], offsets[k].y());
      const Eigen::Vector3d x = random.InCube(4.0);
      const Eigen::Vector4d at = plan.maps[k].map_from_world * x.homogeneous();
      EXPECT_NEAR(Dot(map.u_row, x), at[0], kFloatRounding * SizeOf(map.u_row, x));
      EXPECT_NEAR(Dot(map.v_row, x), at[1], kFloatRounding * SizeOf(map.v_row, x));
      EXPECT_NEAR(Dot(map.z_row, x), at[2], kFloatRounding * SizeOf(map.z_row, x));
      EXPECT_NEAR(Dot(map.w_row, x), at[3], kFloatRounding * SizeOf(map.w_row, x));
    }
  }
}

// What stands in docs/plans.md for those who have the matrices alone.
double CByHand(const Eigen::Matrix4d& map_from_world, const Light& light) {
  Eigen::Matrix<double, 3, 4> rows;
  rows << map_from_world.row(0), map_from_world.row(1), map_from_world.row(3);
  Eigen::Matrix3d columns;
  if (light.kind == Light::Kind::kPoint) {
    columns = rows.leftCols<3>();
  } else {
    const Eigen::Matrix3d frame = FrameAlong(light.direction);
    columns << rows.leftCols<3>() * frame.row(0).transpose(),
        rows.leftCols<3>() * frame.row(1).transpose(), rows.col(3);
  }
  return std::pow(std::abs(columns.determinant()), -1.0 / 3.0);
}

TEST(PlanUniforms, CTimesWIsTheLookUpsCoarsenessAtAnyScaleOfTheMatrix) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const Light light = RandomPlanLight(random);
    const Plan plan = RandomPlan(light, random);
    const auto look_up = PlanLookUp::Create(plan, light);
    ASSERT_THAT(look_up, IsOk());
    Plan scaled = plan;
    for (PlanMap& map : scaled.maps) map.map_from_world *= random.LogUniform(1e-6, 1e6);
    const auto uniforms = MakePlanUniforms(scaled, light);
    ASSERT_THAT(uniforms, IsOk());
    for (int k = 0; k < look_up->num_maps(); ++k) {
      const PlanMapUniforms& map = uniforms->maps[k];
      // Determinants of random maps lose a few of 16 digits at worst.
      EXPECT_LE(RelativeError(map.c, CByHand(scaled.maps[k].map_from_world, light)),
                kFloatRounding + 1e-10);
      const Eigen::Vector3d x = random.InCube(4.0);
      EXPECT_NEAR(map.c * Dot(map.w_row, x),
                  look_up->CoarsenessOf(k, x),
                  2.0 * kFloatRounding * map.c * SizeOf(map.w_row, x));
    }
  }
}

TEST(PlanUniforms, AnOriginNearTheReceiversKeepsTheirDigits) {
  Random random(3);
  const Eigen::Vector3d far(2e5, -3e5, 1e4);
  const Light light = Light::Point("lamp", far + Eigen::Vector3d(0.0, 0.0, 3.0));
  Plan plan;
  plan.maps = {RandomPlanMap(light, random)};
  const auto about_zero = MakePlanUniforms(plan, light);
  const auto about_far = MakePlanUniforms(plan, light, 0.0, {}, far);
  ASSERT_THAT(about_zero, IsOk());
  ASSERT_THAT(about_far, IsOk());
  // A double keeps some 1e-9 of a row whose terms are of size 1e8.
  constexpr double kTolerance = 1e-6;
  double worst_about_zero = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d x = random.InCube(2.0);
    const Eigen::Vector3d world = far + x;
    const Eigen::Vector4d at = plan.maps[0].map_from_world * world.homogeneous();
    const double size = SizeOf(about_far->maps[0].u_row, x);
    EXPECT_NEAR(Dot(about_far->maps[0].u_row, x), at[0], kTolerance * size);
    worst_about_zero =
        std::max(worst_about_zero, std::abs(Dot(about_zero->maps[0].u_row, world) - at[0]) / size);
  }
  EXPECT_GT(worst_about_zero, 100.0 * kTolerance);
  EXPECT_EQ(about_far->maps[0].c, about_zero->maps[0].c);
}

// docs/plans.md: of n texels that a filter reads along u, all are in the map exactly where the look
// up keeps (n - 1) / 2 of a texel from its sides.
TEST(PlanUniforms, GuardOfAFilterIsHalfOfItsTexelsButOne) {
  constexpr int kWidth = 16;
  constexpr double kTexelsAcrossV = 100.0;
  // A sun that shines along -z on a map whose texels are squares of x and y.
  const Light light = Light::Directional("sun", {0.0, 0.0, -1.0});
  Plan plan;
  PlanMap& map = plan.maps.emplace_back();
  map.size = {kWidth, static_cast<int>(kTexelsAcrossV)};
  for (int n = 1; n <= 6; ++n) {
    const double guard = 0.5 * (n - 1);
    const auto look_up = PlanLookUp::Create(plan, light, guard);
    ASSERT_THAT(look_up, IsOk());
    int num_inside = 0, num_outside = 0;
    for (int i = 0; i < 1000; ++i) {
      const double u = (i + 0.37) / 1000.0 * kWidth;
      // The first of the n texels whose middle is nearest to u.
      const int first = static_cast<int>(std::floor(u - guard));
      const bool is_inside = first >= 0 && first + n <= kWidth;
      EXPECT_EQ(look_up->At({u, 0.5 * kTexelsAcrossV, 0.0}).map, is_inside ? 0 : -1)
          << n << " texels at " << u;
      ++(is_inside ? num_inside : num_outside);
    }
    EXPECT_GT(num_inside, 500) << n;
    EXPECT_EQ(num_outside > 0, n > 1) << n;
  }
}

TEST(PlanUniforms, SaysWhatTheBlockCannotHold) {
  Random random(4);
  const Light light = Light::Directional("sun", {0.1, 0.2, -1.0});
  Plan plan;
  EXPECT_THAT(MakePlanUniforms(plan, light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("0 maps, want 1 ... 32")));
  plan.maps = {RandomPlanMap(light, random), RandomPlanMap(light, random)};
  EXPECT_THAT(MakePlanUniforms(plan, light, 500.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin")));
  const Eigen::Vector2i one_offset[] = {{0, 0}};
  EXPECT_THAT(MakePlanUniforms(plan, light, 0.0, one_offset),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("light \"sun\": 1 atlas_offsets for 2 maps")));
  EXPECT_THAT(
      MakePlanUniforms(
          plan, light, 0.0, {}, Eigen::Vector3d(std::numeric_limits<double>::quiet_NaN(), 0, 0)),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map 0, or the origin")));
  Plan large = plan;
  large.maps[1].map_from_world *= 1e60;
  EXPECT_THAT(MakePlanUniforms(large, light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map 1, or the origin")));
  plan.maps[1].half_spaces = {Eigen::RowVector4d(0.0, 1.0, 0.0, 0.0)};
  EXPECT_THAT(MakePlanUniforms(plan, light),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map 1 has half_spaces")));
}

TEST(PlanUniforms, HoldsAPlanOfTheMostMaps) {
  Random random(5);
  const Light light = Light::Point("lamp", {1.0, 2.0, 3.0});
  Plan plan;
  for (int k = 0; k < kMaxPlanMaps; ++k) plan.maps.push_back(RandomPlanMap(light, random));
  const auto uniforms = MakePlanUniforms(plan, light);
  ASSERT_THAT(uniforms, IsOk());
  EXPECT_EQ(BytesOf(*uniforms), sizeof(PlanUniforms));
}

}  // namespace
}  // namespace lightfit
