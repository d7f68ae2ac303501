#include "partition/published/refocused_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "methods/view_body.h"
#include "partition/published/separating_plane.h"
#include "partition/published/view_grid.h"
#include "tests/methods/random_input.h"
#include "tests/partition/published/plan_or_reason.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::LevelView;
using testing::Random;
using testing::RandomInput;
using testing::StatusIs;

Eigen::RowVector4d Unit(const Eigen::RowVector4d& plane) { return plane / plane.head<3>().norm(); }

// A level view to a depth of 100 from a sun behind the viewer's right shoulder.
MethodInput SunView() {
  MethodInput input = LevelView({0.2, -1.0, -0.1});
  input.camera.far = 100.0;
  return input;
}

// Planes draw nearer to one another by about the same factor in every round, and end where each map
// is fitted to the side on which it is the denser.
TEST(RefocusMaps, ConvergeLinearlyForASun) {
  for (const Method second : {Method::kLispsm, Method::kPerspective, Method::kTrapezoidal}) {
    const MethodInput input = SunView();
    RefocusOptions options;
    options.second = second;
    const auto result = RefocusMaps(input, options);
    ASSERT_THAT(result, IsOk());
    ASSERT_EQ(result->rounds.size(), 20u);
    // The second round has the plane of the first.
    EXPECT_EQ(result->rounds[0].plane, result->rounds[1].plane);
    std::vector<double> changes;
    for (size_t i = 2; i < 20; ++i) {
      changes.push_back((Unit(result->rounds[i].plane) - Unit(result->rounds[i - 1].plane)).norm());
    }
    std::printf("%s:", MethodName(second));
    for (size_t i = 1; i < 8; ++i) {
      std::printf(" %.3f", changes[i] / changes[i - 1]);
      EXPECT_LT(changes[i], 0.95 * changes[i - 1]);
    }
    std::printf("\n");
    EXPECT_LT(changes.back(), 1e-9 * changes[0]);

    const RefocusRound& last = result->rounds.back();
    const auto plane = SeparatingPlane(
        last.plan.maps[0].map_from_world, last.plan.maps[1].map_from_world, input.light);
    ASSERT_THAT(plane, IsOk());
    EXPECT_LT((Unit(*plane) - Unit(last.plane)).norm(), 1e-8);
    // The focused map has what is far, the other one what is near.
    EXPECT_GT(last.plane.dot(Eigen::Vector4d(0.0, 0.0, -100.0, 1.0)), 0.0);
    EXPECT_LT(last.plane.dot(Eigen::Vector4d(0.0, 0.0, -1.0, 1.0)), 0.0);
    EXPECT_LT(last.texel_side, result->rounds[0].texel_side);
  }
}

TEST(RefocusMaps, ALampsMapsSwapSidesAndTheBestRoundIsKept) {
  MethodInput input = LevelView({0.0, -1.0, 0.0});
  input.light = Light::Point("lamp", {3.0, 12.0, -12.0});
  const auto result = RefocusMaps(input);
  ASSERT_THAT(result, IsOk());
  const Eigen::Vector4d eye = EyePosition(input.camera).homogeneous();
  int num_swaps = 0;
  const std::vector<RefocusRound>& rounds = result->rounds;
  for (size_t i = 2; i < rounds.size() && rounds[i].plan.maps.size() == 2; ++i) {
    num_swaps += (rounds[i].plane.dot(eye) > 0.0) != (rounds[i - 1].plane.dot(eye) > 0.0) ? 1 : 0;
  }
  EXPECT_GE(num_swaps, 2);
  EXPECT_LT(rounds[result->best].texel_side, rounds[0].texel_side);
  EXPECT_LT(rounds[result->best].texel_side, rounds.back().texel_side);
}

TEST(RefocusMaps, EveryReceiverIsServedByTheMapOfItsSide) {
  int num_suns = 0, num_lamps = 0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    MethodInput input = RandomInput(random);
    input.map = {random.Int(100, 600), random.Int(100, 600)};
    RefocusOptions options;
    options.max_rounds = random.Int(1, 6);
    options.second = random.Coin() ? Method::kLispsm : Method::kPerspective;
    options.margin_texels = random.Coin() ? 0.0 : 3.0;
    const auto result = RefocusMaps(input, options);
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (!result.ok() || body.empty()) continue;
    ASSERT_LE(result->rounds.size(), static_cast<size_t>(options.max_rounds));
    for (const RefocusRound& round : result->rounds) {
      ASSERT_LE(NumTexels(round.plan), int64_t{input.map.width} * input.map.height);
      ASSERT_EQ(round.plan.maps.size(), round.only < 0 ? 2u : 1u);
      if (round.only >= 0) continue;
      const bool is_sun = input.light.kind == Light::Kind::kDirectional;
      for (const PlanMap& map : round.plan.maps) {
        EXPECT_EQ(map.half_spaces.size(), is_sun ? 1u : 0u);
      }
      ++(is_sun ? num_suns : num_lamps);
      const auto look_up = PlanLookUp::Create(round.plan, input.light, options.margin_texels);
      ASSERT_THAT(look_up, IsOk());
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d receiver = testing::PointIn(random, body);
        const double side = round.plane.dot(receiver.homogeneous());
        const PlanPlace place = look_up->At(receiver);
        ASSERT_GE(place.map, 0) << "seed " << seed;
        Eigen::Vector2d texel;
        if (is_sun) {
          EXPECT_EQ(place.map, side >= 0.0 ? 0 : 1);
        } else {
          // The map of its side holds it, and is asked unless the other is denser.
          const int own = side >= 0.0 ? 0 : 1;
          EXPECT_TRUE(look_up->IsAskable(own, receiver, &texel));
          EXPECT_LE(look_up->CoarsenessOf(place.map, receiver),
                    look_up->CoarsenessOf(own, receiver));
        }
      }
    }
  }
  EXPECT_GT(num_suns, 50);
  EXPECT_GT(num_lamps, 50);
}

TEST(RefocusMaps, KeepTheRoundWithTheLeastTexels) {
  int num_later = 0;
  for (uint64_t seed = 1; seed <= 15; ++seed) {
    Random random(seed);
    const MethodInput input = RandomInput(random);
    RefocusOptions options;
    options.max_rounds = 6;
    const auto result = RefocusMaps(input, options);
    const auto plan = SeparatingPlanePlan(input, options);
    ASSERT_EQ(result.ok(), plan.ok());
    if (!result.ok()) continue;
    const std::vector<ViewGridPoint> grid = ViewGrid(input);
    for (size_t i = 0; i < result->rounds.size(); ++i) {
      const RefocusRound& round = result->rounds[i];
      const auto look_up = PlanLookUp::Create(round.plan, input.light);
      ASSERT_THAT(look_up, IsOk());
      EXPECT_EQ(round.texel_side, MeanTexelSide(*look_up, grid));
      const double best = result->rounds[result->best].texel_side;
      EXPECT_TRUE(i < result->best ? round.texel_side > best : round.texel_side >= best);
    }
    num_later += result->best > 0 ? 1 : 0;
    const Plan& best = result->rounds[result->best].plan;
    ASSERT_EQ(plan->maps.size(), best.maps.size());
    EXPECT_EQ(std::string(plan->light_name), input.light.name);
    for (size_t k = 0; k < best.maps.size(); ++k) {
      EXPECT_EQ(plan->maps[k].map_from_world, best.maps[k].map_from_world);
      EXPECT_EQ(plan->maps[k].half_spaces.size(), best.maps[k].half_spaces.size());
    }
  }
  EXPECT_GT(num_later, 5);
}

TEST(RefocusMaps, OneMapRemainsWithAllTexelsWhereTheOtherIsNowhereDenser) {
  // A light along the view has no warp: both maps are the same.
  MethodInput input = LevelView({0.0, 0.0, -1.0});
  input.map = {300, 300};
  auto result = RefocusMaps(input);
  ASSERT_THAT(result, IsOk());
  ASSERT_EQ(result->rounds.size(), 1u);
  ASSERT_EQ(result->rounds[0].plan.maps.size(), 1u);
  const PlanMap& map = result->rounds[0].plan.maps[0];
  EXPECT_EQ(map.size.width, 300);
  EXPECT_EQ(map.size.height, 300);
  EXPECT_TRUE(map.half_spaces.empty());
  EXPECT_EQ(result->rounds[0].only, 0);

  // Two maps without a warp: the tighter one is denser everywhere, whichever comes second.
  input = LevelView({0.2, -1.0, 0.1});
  for (const bool is_tight_first : {false, true}) {
    RefocusOptions options;
    options.first = is_tight_first ? Method::kFocused : Method::kStandard;
    options.second = is_tight_first ? Method::kStandard : Method::kFocused;
    result = RefocusMaps(input, options);
    ASSERT_THAT(result, IsOk());
    const Plan& plan = result->rounds[result->best].plan;
    ASSERT_EQ(plan.maps.size(), 1u);
    EXPECT_EQ(result->rounds[result->best].only, is_tight_first ? 0 : 1);
    RefocusOptions focused;
    focused.first = focused.second = Method::kFocused;
    const auto expected = RefocusMaps(input, focused);
    ASSERT_THAT(expected, IsOk());
    EXPECT_EQ(plan.maps[0].map_from_world, expected->rounds[0].plan.maps[0].map_from_world);
  }
}

TEST(RefocusMaps, WithNothingInViewOneMapHasAllReceivers) {
  MethodInput input = LevelView({0.2, -1.0, 0.1});
  input.receivers = {Eigen::Vector3d(-1.0, -1.0, 50.0), Eigen::Vector3d(1.0, 1.0, 52.0)};
  const auto plan = SeparatingPlanePlan(input);
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 1u);
  const auto look_up = PlanLookUp::Create(*plan, input.light);
  ASSERT_THAT(look_up, IsOk());
  for (const Eigen::Vector3d& corner : BoxCorners(input.receivers)) {
    EXPECT_EQ(look_up->At(corner).map, 0);
  }
}

TEST(RefocusMaps, HardInputGivesPlansOrReasons) {
  Random random(11);
  int num_plans = 0;
  for (int i = 0; i < 200; ++i) {
    const MethodInput input = testing::HardInput(random);
    num_plans += testing::IsPlanOrReason(SeparatingPlanePlan(input), input) ? 1 : 0;
  }
  EXPECT_GT(num_plans, 50);
}

TEST(RefocusMaps, SaysWhatIsWrong) {
  MethodInput input = SunView();
  RefocusOptions options;
  options.max_rounds = 0;
  EXPECT_THAT(RefocusMaps(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_rounds = 0")));
  options = {};
  options.margin_texels = std::nan("");
  EXPECT_THAT(RefocusMaps(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin_texels = nan")));
  options.margin_texels = 200.0;
  EXPECT_THAT(RefocusMaps(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin of 200")));
  input.camera.far = 0.5;
  EXPECT_THAT(SeparatingPlanePlan(input),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("far = 0.5")));
  input = SunView();
  input.light = Light::Point("lamp", {0.0, 0.0, -8.0});
  EXPECT_THAT(SeparatingPlanePlan(input),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("lamp")));
}

}  // namespace
}  // namespace lightfit
