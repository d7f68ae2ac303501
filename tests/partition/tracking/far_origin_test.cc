// Plans of the same scene in other units and far from the origin. How a plan divides a light hangs
// on comparisons that the last bit decides, at any distance: to the bit the same are plans in units
// of a power of two, and in the mean those at a distance.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "partition/fit_plan.h"
#include "partition/plan.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/partition/tracking/tracked_plan.h"
#include "tests/testing/matchers.h"
#include "tests/testing/moved_scene.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::Move;
using testing::OptionsOf;
using testing::PlanWalk;
using testing::Random;
using testing::RandomMove;

struct MovedWalk {
  PlanWalk walk;
  std::vector<Light> lights;
  std::vector<SyntheticReadback> images;
  std::vector<Surfaces> frames;

  MovedWalk(uint64_t seed, int num_frames, const Move& move)
      : walk(seed, num_frames, /*step=*/0.15), lights(move.Of(walk.lights)) {
    for (const SyntheticReadback& image : walk.images) images.push_back(move.Of(image));
    for (const SyntheticReadback& image : images) {
      frames.push_back(*FindSurfaces(image.ViewWithFacing(), 0x7, {}));
    }
  }
};

TEST(FarOriginPlans, InOtherUnitsTrackedPlansAreTheSameToTheBit) {
  Random random(146);
  for (uint64_t seed = 40; seed < 42; ++seed) {
    Move move = RandomMove(random);
    move.offset.setZero();
    const MovedWalk moved(seed, 3, move);
    for (size_t i = 0; i < moved.lights.size(); ++i) {
      PlanTracker here(moved.walk.lights[i], OptionsOf(4, 0.5));
      PlanTracker there(moved.lights[i], OptionsOf(4, 0.5));
      for (size_t frame = 0; frame < moved.frames.size(); ++frame) {
        const auto first = here.Update(moved.walk.frames[frame]);
        const auto second = there.Update(moved.frames[frame]);
        ASSERT_EQ(first.status().code(), second.status().code()) << second.status();
        if (!first.ok()) continue;
        EXPECT_EQ(first->plan.energy, second->plan.energy);
        EXPECT_EQ(first->actions, second->actions);
      }
    }
  }
}

TEST(FarOriginPlans, AtAnyDistancePlansAreAsGood) {
  Random random(147);
  constexpr double kAsGood = 0.1;  // the mean of 16 logarithms, of which one may be 0.4
  double sum = 0.0, sum_of_single = 0.0;
  int num_plans = 0;
  for (uint64_t seed = 40; seed < 47; ++seed) {
    const Move move = RandomMove(random);
    const MovedWalk moved(seed, 1, move);
    for (size_t i = 0; i < moved.lights.size(); ++i) {
      PlanOptions options = OptionsOf(4, 0.0).plan;
      const auto here = FitPlan(moved.walk.frames[0], moved.walk.lights[i], options);
      const auto there = FitPlan(moved.frames[0], moved.lights[i], options);
      ASSERT_EQ(here.status().code(), there.status().code()) << there.status();
      if (!here.ok() || here->energy == 0.0) continue;
      sum += std::log(there->energy / here->energy);
      options.max_maps = 1;
      sum_of_single +=
          std::abs(std::log(FitPlan(moved.frames[0], moved.lights[i], options)->energy /
                            FitPlan(moved.walk.frames[0], moved.walk.lights[i], options)->energy));
      ++num_plans;
    }
  }
  ASSERT_GE(num_plans, 14);
  EXPECT_NEAR(sum / num_plans, 0.0, kAsGood);
  EXPECT_LT(sum_of_single / num_plans, 1e-5);  // nothing to divide
}

TEST(FarOriginPlans, ReceiversAskTheSameMapInTheSamePlace) {
  Random random(148);
  int num_asked = 0;
  for (uint64_t seed = 40; seed < 44; ++seed) {
    const Move move = RandomMove(random);
    const PlanWalk walk(seed, 1, 0.0);
    for (size_t i = 0; i < walk.lights.size(); ++i) {
      const auto fitted = FitPlan(walk.frames[0], walk.lights[i], OptionsOf(4, 0.0).plan);
      if (!fitted.ok()) continue;
      const Plan plan = PlanOf(*fitted);
      Plan moved_plan = plan;
      for (PlanMap& map : moved_plan.maps) map.map_from_world *= move.MovedFromWorld().inverse();
      const Light moved_light = move.Of(walk.lights[i]);
      const auto here = PlanLookUp::Create(plan, walk.lights[i]);
      const auto there = PlanLookUp::Create(moved_plan, moved_light);
      ASSERT_THAT(here, IsOk());
      ASSERT_THAT(there, IsOk());
      for (int k = 0; k < 2000; ++k) {
        const Eigen::Vector3d receiver(random.Uniform(-20, 20), random.Uniform(-20, 20), 0.0);
        const PlanPlace first = here->At(receiver);
        const PlanPlace second = there->At(move.scale * receiver + move.offset);
        // At a border between maps rounding may decide.
        if (first.map != second.map) continue;
        if (first.map < 0) continue;
        ++num_asked;
        EXPECT_LT((first.texel - second.texel).norm(), 1e-8 + 2e-11 * move.Distance());
      }
    }
  }
  EXPECT_GE(num_asked, 1000);
}

}  // namespace
}  // namespace lightfit
