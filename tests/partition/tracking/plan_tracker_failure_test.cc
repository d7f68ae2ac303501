// What a tracker of plans does where the frame has no plan of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "partition/fit_plan.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/partition/tracking/tracked_plan.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ExpectActions;
using testing::ExpectConsistent;
using testing::ExpectHeld;
using testing::ExpectSameState;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::OptionsOf;
using testing::PlanWalk;
using testing::StatusIs;
using testing::Where;

constexpr auto kFailed = absl::StatusCode::kFailedPrecondition;

// The same maps with what they hold drawn together around their middles: they hold it still, in
// texels that are so many times as long.
TrackedPlanState Coarser(TrackedPlanState state, double times) {
  for (TrackedPlanState::Map& map : state.maps) {
    Eigen::Matrix4d& matrix = map.map_from_world;
    const double kept = 1.0 / times, middle = 0.5 * (1.0 - kept);
    matrix.row(0) = kept * matrix.row(0) + middle * map.size.width * matrix.row(3);
    matrix.row(1) = kept * matrix.row(1) + middle * map.size.height * matrix.row(3);
  }
  return state;
}

void ExpectHeldAsBefore(const TrackedPlan& tracked,
                        const TrackedPlanState& before,
                        const Surfaces& surfaces,
                        const PlanTrackerOptions& options) {
  EXPECT_FALSE(tracked.is_new);
  EXPECT_FALSE(tracked.is_updated);
  ExpectConsistent(tracked, options);
  ExpectActions(before, tracked);
  ExpectHeld(tracked, surfaces, before.light, options);
}

// In frames that are fitted anew and in those between. The margin leaves nothing of any map.
TEST(PlanTracker, KeepsWhatHoldsWhereNoPlanCanBeFitted) {
  constexpr double kNoRoom = 150.0;  // texels, of maps of 200 in all
  const PlanWalk walk(1, 1, 0.0);
  for (const Light& light : walk.lights) {
    for (const int max_maps : {1, 3}) {
      for (const int update_every_frames : {1, 4}) {
        SCOPED_TRACE(Where(1, light, 0));
        PlanTrackerOptions options = OptionsOf(max_maps, 0.5);
        options.update_every_frames = update_every_frames;
        PlanTracker tracker(light, options);
        ASSERT_THAT(tracker.Update(walk.frames[0]), IsOk());
        options.plan.fit.margin_texels = kNoRoom;
        tracker.set_options(options);
        ASSERT_FALSE(FitPlan(walk.frames[0], light, options.plan).ok());
        for (int frame = 1; frame < 4; ++frame) {
          const TrackedPlanState before = tracker.state();
          const auto tracked = tracker.Update(walk.frames[0]);
          ASSERT_THAT(tracked, IsOk());
          ExpectHeldAsBefore(*tracked, before, walk.frames[0], options);
          EXPECT_EQ(tracked->NumRedrawn(), 0);
        }
        // Without anything that holds there is the error, and the tracker is as it was.
        const TrackedPlanState before = tracker.state();
        options.plan.texels = 100 * 100;
        tracker.set_options(options);
        EXPECT_FALSE(tracker.Update(walk.frames[0]).ok());
        ExpectSameState(tracker.state(), before);
      }
    }
  }
}

// The maps could be better by far, and of as many as there are it is known how much; but of so many
// as are asked for each would be too small. Single maps are not fitted anew either, mostly: the
// room that they make costs more than the tolerance allows.
TEST(PlanTracker, KeepsWhatCostsTooMuchWhereNoPlanCanBeFitted) {
  struct Case {
    int num_before, max_maps;
    double margin_texels;  // leaves 80 of 200 texels a side, or 50 of 100; of the new maps nothing
  };
  int num_kept = 0;
  const PlanWalk walk(1, 1, 0.0);
  for (const Light& light : walk.lights) {
    for (const Case& at : {Case{1, 4, 60.0}, Case{4, 16, 25.0}}) {
      SCOPED_TRACE(Where(1, light, 0));
      PlanTrackerOptions options = OptionsOf(at.num_before, 0.5);
      options.tolerance = 0.01;
      PlanTracker tracker(light, options);
      ASSERT_THAT(tracker.Update(walk.frames[0]), IsOk());
      const TrackedPlanState before = Coarser(tracker.state(), 20.0);
      ASSERT_EQ(before.maps.size(), static_cast<size_t>(at.num_before));
      options.cover_margin_percent = 50.0;
      options.plan.max_maps = at.max_maps;
      options.plan.fit.margin_texels = at.margin_texels;
      ASSERT_THAT(FitPlan(walk.frames[0], light, options.plan),
                  StatusIs(kFailed, HasSubstr("leave nothing of a map")));
      tracker.set_options(options);
      tracker.set_state(before);
      const auto tracked = tracker.Update(walk.frames[0]);
      ASSERT_THAT(tracked, IsOk());
      ExpectHeldAsBefore(*tracked, before, walk.frames[0], options);
      if (tracked->NumRedrawn() > 0) continue;
      ++num_kept;
      EXPECT_GT(tracked->plan.energy, (1.0 + options.tolerance) * tracked->best_energy);
    }
  }
  EXPECT_GE(num_kept, 5);  // of six
}

}  // namespace
}  // namespace lightfit
