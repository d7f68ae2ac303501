// What a shot's frame has beside its plans, written and read back.

#include "wire/plan_shot_proto.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::Random;
using testing::StatusIs;

TrackedPlanState RandomState(Random& random) {
  TrackedPlanState state;
  state.light.name = "key";
  state.border = random.Coin() ? Border::kLit : Border::kDark;
  state.frames_since_update = random.Int(0, 9);
  const int num_maps = random.Int(1, 8);
  for (int k = 0; k < num_maps; ++k) {
    TrackedPlanState::Map& map = state.maps.emplace_back();
    for (double& number : map.map_from_world.reshaped()) number = random.LogUniform(1e-12, 1e12);
    map.size = {random.Int(1, 4096), random.Int(1, 4096)};
    map.frames_kept = random.Int(0, 1000);
  }
  return state;
}

// A tracker that goes on from a file must not differ in the last bit.
TEST(PlanShotProto, StatesReadBackExactlyThroughJson) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const TrackedPlanState state = RandomState(random);
    v1::TrackedState read;
    ASSERT_THAT(JsonToProto(ProtoToJson(TrackedPlanStateToProto(state)).value(), read), IsOk());
    const absl::StatusOr<TrackedPlanState> back = TrackedPlanStateFromProto(read, "state[0]");
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(back->light.name, state.light.name);
    EXPECT_EQ(back->border, state.border);
    EXPECT_EQ(back->frames_since_update, state.frames_since_update);
    ASSERT_EQ(back->maps.size(), state.maps.size());
    for (size_t k = 0; k < state.maps.size(); ++k) {
      EXPECT_EQ(back->maps[k].map_from_world, state.maps[k].map_from_world);
      EXPECT_EQ(back->maps[k].size.width, state.maps[k].size.width);
      EXPECT_EQ(back->maps[k].size.height, state.maps[k].size.height);
      EXPECT_EQ(back->maps[k].frames_kept, state.maps[k].frames_kept);
    }
  }
}

TEST(PlanShotProto, SettingsAreThoseOfTheTracker) {
  const PlanTrackerOptions options = PlanTrackerOptions::ForStability(0.7);
  const auto back = PlanTrackerSettingsFromProto(PlanTrackerSettingsToProto(options));
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->tolerance, options.tolerance);
  EXPECT_EQ(back->update_every_frames, options.update_every_frames);
  EXPECT_EQ(back->cover_margin_percent, options.cover_margin_percent);
  v1::PlanTrackerSettings bad = PlanTrackerSettingsToProto(options);
  bad.set_cover_margin_percent(-1.0);
  EXPECT_THAT(PlanTrackerSettingsFromProto(bad),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       ::testing::StartsWith("plan_tracker.cover_margin_percent = -1")));
}

TEST(PlanShotProto, SaysOfEachMapWhatBecameOfIt) {
  TrackedPlan tracked;
  tracked.actions = {TrackerAction::kKept, TrackerAction::kShifted, TrackerAction::kInvalid};
  tracked.frames_kept = {7, 3, 0};
  const v1::ShotPlan shot = ShotPlanToProto(tracked);
  EXPECT_FALSE(shot.is_new());
  ASSERT_EQ(shot.maps_size(), 3);
  EXPECT_EQ(shot.maps(0).action(), v1::TRACKER_ACTION_KEPT);
  EXPECT_EQ(shot.maps(1).action(), v1::TRACKER_ACTION_SHIFTED);
  EXPECT_EQ(shot.maps(2).action(), v1::TRACKER_ACTION_INVALID);
  EXPECT_EQ(shot.maps(0).frames_kept(), 7);
}

}  // namespace
}  // namespace lightfit
