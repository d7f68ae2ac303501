// A frame loop's plans take nothing from the heap once their pool has seen the work.
#include <gtest/gtest.h>

#include <utility>

#include "base/scratch.h"
#include "partition/fit_plan.h"
#include "partition/tracking/async_planner.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/testing/allocation_counter.h"
#include "tests/testing/fine_image.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::FineImage;
using testing::NumAllocations;
using testing::PlanWalk;
using testing::TestScene;

TEST(FitPlan, AllocatesNothingFromAWarmPool) {
  constexpr int kNumRounds = 4;
  const TestScene scene(/*seed=*/1, 3, 96, 64);
  const TestScene large(/*seed=*/1, 3, 192, 128);
  const FineImage fine(large.readback);
  Readback readback = scene.readback.ViewWithFacing();
  PlanOptions options;
  options.max_maps = 4;
  for (const auto& [choose, is_fine] :
       {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
    options.choose_by_forecast = choose;
    readback.fine_cover = is_fine ? &fine.cover : nullptr;
    ScratchPool pool;
    for (int round = 0; round < kNumRounds; ++round) {
      const ScratchScope scope(&pool);
      const int64_t before = NumAllocations();
      const auto surfaces = FindSurfaces(readback, 0x7, options.fit.samples);
      for (const Light& light : scene.lights) {
        const auto plan = FitPlan(*surfaces, light, options);
        ASSERT_TRUE(plan.ok());  // a matcher would allocate
      }
      if (round > 1) {
        EXPECT_EQ(NumAllocations() - before, 0) << "round " << round;
      }
    }
  }
}

// As long as maps are kept or moved: a fit that is tried and fails says why, in a message.
TEST(PlanTracker, AllocatesNothingFromAWarmPoolWhileMapsAreKept) {
  constexpr int kNumRounds = 3;
  const PlanWalk walk(1, 6, 0.1);
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(0.5);
  options.plan.max_maps = 4;
  options.plan.texels = int64_t{200} * 200;
  options.plan.choose_by_forecast = false;
  int num_kept = 0;
  for (const Light& light : walk.lights) {
    PlanTracker tracker(light, options);
    ScratchPool pool;
    for (int round = 0; round < kNumRounds; ++round) {
      TrackedPlanState start;
      start.light = light;
      tracker.set_state(start);
      for (const Surfaces& surfaces : walk.frames) {
        const ScratchScope scope(&pool);
        const int64_t before = NumAllocations();
        const auto tracked = tracker.Update(surfaces);
        const int64_t taken = NumAllocations() - before;
        ASSERT_TRUE(tracked.ok());
        if (round + 1 < kNumRounds || tracked->NumRedrawn() > 0) continue;
        EXPECT_EQ(taken, 0) << light.name;
        ++num_kept;
      }
    }
  }
  EXPECT_GT(num_kept, 5);
}

// Under a camera that stands still, as above.
TEST(AsyncPlanner, AllocatesNothingAfterTheFirstFramesWhileMapsAreKept) {
  const testing::BoxWalk walk(/*seed=*/21, /*num_lights=*/2, /*num_views=*/1, 48, 48);
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(0.5);
  options.plan.max_maps = 3;
  options.plan.texels = 40'000;
  options.plan.choose_by_forecast = false;
  AsyncPlanner planner = std::move(AsyncPlanner::Start(options).value());
  constexpr int kNumFrames = 24;
  int64_t frame = 0, num_failed = 0, num_polled = 0;
  const auto run = [&] {
    for (int i = 0; i < kNumFrames; ++i, ++frame) {
      testing::Fill(walk.views[0], walk.lights, frame, &planner.Lend());
      planner.Submit();
      testing::WaitUntilIdle(planner);
      const FramePlans* plans = planner.Poll();
      if (plans == nullptr) continue;
      ++num_polled;
      for (const Light& light : walk.lights) {
        num_failed += plans->Find(light.name)->status.ok() ? 0 : 1;
      }
    }
  };
  run();
  const int64_t before = NumAllocations();
  run();
  EXPECT_EQ(NumAllocations() - before, 0);
  EXPECT_EQ(num_failed, 0);
  EXPECT_EQ(num_polled, 2 * kNumFrames);  // each is waited for
}

}  // namespace
}  // namespace lightfit
