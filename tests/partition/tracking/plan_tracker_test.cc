#include "partition/tracking/plan_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>

#include "optimizer/tracking/tracker.h"
#include "partition/tracking/kept_map.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/partition/tracking/tracked_plan.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ExpectActions;
using testing::ExpectConsistent;
using testing::ExpectHeld;
using testing::IsOk;
using testing::kStep;
using testing::OptionsOf;
using testing::PlanWalk;
using testing::Where;

TEST(PlanTracker, KeepsEverythingToTheLastBitUnderACameraThatStandsStill) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const PlanWalk walk(seed, 1, 0.0);
    for (const Light& light : walk.lights) {
      for (const int max_maps : {1, 4}) {
        for (const double stability : {0.1, 0.5}) {
          SCOPED_TRACE(Where(seed, light, 0));
          PlanTracker tracker(light, OptionsOf(max_maps, stability));
          const auto first = tracker.Update(walk.frames[0]);
          ASSERT_THAT(first, IsOk());
          EXPECT_TRUE(first->is_new);
          EXPECT_EQ(first->actions[0], TrackerAction::kFirst);
          for (int frame = 1; frame < 5; ++frame) {
            const auto tracked = tracker.Update(walk.frames[0]);
            ASSERT_THAT(tracked, IsOk());
            EXPECT_FALSE(tracked->is_new);
            ASSERT_EQ(tracked->plan.maps.size(), first->plan.maps.size());
            for (size_t k = 0; k < first->plan.maps.size(); ++k) {
              EXPECT_EQ(tracked->actions[k], TrackerAction::kKept);
              EXPECT_EQ(tracked->frames_kept[k], frame);
              EXPECT_EQ(tracked->plan.maps[k].map_from_world, first->plan.maps[k].map_from_world);
            }
            EXPECT_NEAR(tracked->plan.energy, first->plan.energy, 1e-9 * first->plan.energy);
          }
        }
      }
    }
  }
}

TEST(PlanTracker, HoldsWhatMustBeHeldAndKeepsMostMapsOnAWalk) {
  int num_kept = 0, num_shifted = 0, num_redrawn = 0, num_new = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanWalk walk(seed, 7, kStep);
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(4, 0.5);
      if (seed == 2) options.plan.guard_texels = 2.0;
      if (seed == 3) options.plan.fit.border = BorderChoice::kDark;
      if (seed == 4) options.plan.fit.cover = Cover::kReceivers;
      PlanTracker tracker(light, options);
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        SCOPED_TRACE(Where(seed, light, frame));
        const TrackedPlanState before = tracker.state();
        const auto tracked = tracker.Update(walk.frames[frame]);
        ASSERT_THAT(tracked, IsOk());
        ExpectConsistent(*tracked, options);
        ExpectHeld(*tracked, walk.frames[frame], light, options);
        ExpectActions(before, *tracked);
        num_new += tracked->is_new ? 1 : 0;
        for (const TrackerAction action : tracked->actions) {
          num_kept += action == TrackerAction::kKept ? 1 : 0;
          num_shifted += action == TrackerAction::kShifted ? 1 : 0;
          num_redrawn += IsRedrawn(action) ? 1 : 0;
        }
      }
    }
  }
  std::printf("%d kept, %d shifted, %d redrawn, %d new plans\n",
              num_kept,
              num_shifted,
              num_redrawn,
              num_new);
  EXPECT_GT(num_kept + num_shifted, num_redrawn);
  EXPECT_GT(num_shifted, 10);
  EXPECT_GT(num_redrawn, 4 * num_new);  // single maps too
}

TEST(PlanTracker, AtStabilityZeroIsTheFitOfEachFrame) {
  const PlanWalk walk(1, 2, kStep);
  for (const bool choose : {false, true}) {
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(2, 0.0);
      options.plan.choose_by_forecast = choose;
      options.plan.fit.border = choose ? BorderChoice::kAutomatic : BorderChoice::kLit;
      PlanTracker tracker(light, options);
      for (const Surfaces& surfaces : walk.frames) {
        const auto tracked = tracker.Update(surfaces);
        const auto own = FitPlan(surfaces, light, options.plan);
        ASSERT_THAT(tracked, IsOk());
        ASSERT_EQ(tracked->plan.maps.size(), own->maps.size());
        EXPECT_EQ(tracked->plan.energy, own->energy);
        EXPECT_EQ(tracked->plan.border, own->border);
        for (size_t k = 0; k < own->maps.size(); ++k) {
          EXPECT_EQ(tracked->plan.maps[k].map_from_world, own->maps[k].map_from_world);
        }
      }
    }
  }
}

TEST(PlanTracker, NeverCostsMoreThanTheToleranceAllows) {
  struct Choice {
    double stability;
    int update_every_frames;
  };
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    const PlanWalk walk(seed, 6, kStep);
    for (const Light& light : walk.lights) {
      for (const Choice& choice : {Choice{0.2, 1}, Choice{0.5, 3}}) {
        PlanTrackerOptions options = OptionsOf(3, choice.stability);
        options.update_every_frames = choice.update_every_frames;
        PlanTracker tracker(light, options);
        int since_update = 0;
        for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
          SCOPED_TRACE(Where(seed, light, frame));
          const auto tracked = tracker.Update(walk.frames[frame]);
          ASSERT_THAT(tracked, IsOk());
          constexpr double kRounding = 1e-12;
          EXPECT_LE(tracked->plan.energy,
                    (1.0 + choice.stability) * tracked->best_energy * (1.0 + kRounding));
          since_update = tracked->is_updated ? 0 : since_update + 1;
          EXPECT_LT(since_update, choice.update_every_frames);
          if (!tracked->is_updated) continue;
          const auto own = FitPlan(walk.frames[frame], light, options.plan);
          EXPECT_EQ(tracked->best_energy, own->energy);
        }
      }
    }
  }
}

// As long as nothing but validity counts, to the last bit.
TEST(PlanTracker, OfOneMapDoesAsTheTrackerOfOneMap) {
  int num_shifted = 0, num_invalid = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanWalk walk(seed, 10, kStep);
    for (const Light& light : walk.lights) {
      PlanTrackerOptions options = OptionsOf(1, 0.5);
      options.tolerance = 1e9;
      TrackerOptions of_one;
      of_one.replace_below = 0.0;
      of_one.cover_margin_percent = options.cover_margin_percent;
      PlanTracker tracker(light, options);
      Tracker tracker_of_one(of_one);
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        SCOPED_TRACE(Where(seed, light, frame));
        const auto plan = tracker.Update(walk.frames[frame]);
        const auto one = tracker_of_one.Update(walk.frames[frame], {&light, 1}, {200, 200});
        ASSERT_THAT(plan, IsOk());
        ASSERT_THAT(one[0], IsOk());
        ASSERT_EQ(plan->plan.maps.size(), 1u);
        EXPECT_EQ(plan->actions[0], one[0]->action);
        for (const int row : {0, 1, 3}) {
          EXPECT_LT(
              (plan->plan.maps[0].map_from_world.row(row) - one[0]->matrix.map_from_world.row(row))
                  .norm(),
              1e-9 * one[0]->matrix.map_from_world.row(row).norm());
        }
        // A fresh fit says what its search found, whose weights have a floor.
        constexpr double kFloor = 1e-3;
        EXPECT_NEAR(plan->plan.energy, one[0]->matrix.figures.energy, kFloor * plan->plan.energy);
        num_shifted += plan->actions[0] == TrackerAction::kShifted ? 1 : 0;
        num_invalid += plan->actions[0] == TrackerAction::kInvalid ? 1 : 0;
      }
    }
  }
  std::printf("%d shifted, %d invalid\n", num_shifted, num_invalid);
  EXPECT_GT(num_shifted, 3);
  EXPECT_GT(num_invalid, 3);
}

// A lamp between the boxes, of which no single map exists.
TEST(PlanTracker, FollowsALampAmongItsReceivers) {
  int num_lamps = 0, num_kept = 0;
  for (uint64_t seed = 1; seed <= 12 && num_lamps < 2; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const Camera camera = RandomCamera(scene, seed, 96, 72);
    const Eigen::Vector3d eye = camera.camera_from_world.inverse().col(3).head<3>();
    const Eigen::Vector3d forward = camera.camera_from_world.row(2).head<3>();
    const Light light = Light::Point("lamp", eye + 6.0 * forward + Eigen::Vector3d(0.0, 0.0, 0.3));
    PlanTrackerOptions options = OptionsOf(6, 0.5);
    options.plan.fit.cover = Cover::kReceivers;
    PlanTracker tracker(light, options);
    for (int frame = 0; frame < 5; ++frame) {
      Camera moved = camera;
      moved.camera_from_world(0, 3) += 0.1 * frame;
      const SyntheticReadback image = Render(scene, moved, {light});
      const auto surfaces = FindSurfaces(image.ViewWithFacing(), 1, {});
      if (!surfaces.ok()) break;
      PlanOptions one = options.plan;
      one.max_maps = 1;
      if (!absl::IsFailedPrecondition(FitPlan(*surfaces, light, one).status())) break;
      SCOPED_TRACE(Where(seed, light, frame));
      const auto tracked = tracker.Update(*surfaces);
      ASSERT_THAT(tracked, IsOk());
      ExpectHeld(*tracked, *surfaces, light, options);
      num_lamps += frame == 0 ? 1 : 0;
      num_kept += static_cast<int>(tracked->actions.size()) - tracked->NumRedrawn();
    }
  }
  EXPECT_EQ(num_lamps, 2);
  EXPECT_GT(num_kept, 10);
}

}  // namespace
}  // namespace lightfit
