// The stream Track with plan_options: each map of a plan kept by itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "calls/track_session.h"
#include "optimizer/fit.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "tests/testing/plane_readback.h"
#include "wire/plan_proto.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

using testing::Yard;

constexpr int kMaxMaps = 3;
constexpr int64_t kTexels = 60000;

v1::TrackSetup SetupFor(double stability) {
  v1::TrackSetup setup;
  setup.mutable_plan_options()->set_max_maps(kMaxMaps);
  setup.mutable_plan_options()->set_texels(kTexels);
  setup.set_stability(stability);
  return setup;
}

PlanTrackerOptions OptionsFor(double stability) {
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
  options.plan.max_maps = kMaxMaps;
  options.plan.texels = kTexels;
  return options;
}

// Frames that see different parts of the yard, of two lights.
struct Frames {
  std::vector<Light> lights = {Yard().lights[0], Yard().lights[1]};
  std::vector<ReadbackFile> files;
  std::vector<v1::TrackFrame> messages;

  explicit Frames(int count) {
    for (int i = 0; i < count; ++i) {
      files.push_back(testing::FrameOfYard(i));
      auto frame = testing::RequestOf<v1::TrackFrame>(files.back().View(), lights);
      frame.set_number(100 + i);
      messages.push_back(std::move(frame));
    }
  }
};

TrackSession Begun(const v1::TrackSetup& setup) {
  absl::StatusOr<TrackSession> session = TrackSession::Begin(setup);
  EXPECT_THAT(session, testing::IsOk());
  return *std::move(session);
}

TEST(PlanTrack, SaysThatItDoesNotLookAtAFinerCover) {
  const Frames frames(1);
  Readback readback = frames.files[0].View();
  FineCover cover;
  cover.columns = readback.width();
  cover.rows = readback.height();
  cover.nearest = readback.depth;
  cover.shadow_bits = readback.shadow_bits;
  readback.fine_cover = &cover;
  TrackSession session = Begun(SetupFor(0.5));
  const v1::TrackResult answer = session.Update(frames.messages[0], readback, {});
  EXPECT_EQ(answer.status().code(), static_cast<int>(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(
      answer.status().message(),
      ::testing::HasSubstr("readback.fine_cover: plans that are tracked do not look at it"));
}

TEST(PlanTrack, DoesWhatTheTrackerDoes) {
  const Frames frames(4);
  int num_kept = 0;
  for (const double stability : {0.0, 0.5}) {
    std::vector<PlanTracker> trackers;
    for (const Light& light : frames.lights) trackers.emplace_back(light, OptionsFor(stability));
    TrackSession session = Begun(SetupFor(stability));
    for (size_t f = 0; f < frames.files.size(); ++f) {
      const Readback readback = frames.files[f].View();
      const auto surfaces = FindSurfaces(readback, LightMask(frames.lights), {});
      ASSERT_THAT(surfaces, testing::IsOk());
      const v1::TrackResult answer = session.Update(frames.messages[f], readback, {});
      EXPECT_EQ(answer.number(), 100 + static_cast<int>(f));
      ASSERT_EQ(answer.status().code(), 0) << answer.status().message();
      EXPECT_EQ(answer.result().plan_options().max_maps(), kMaxMaps);
      ASSERT_EQ(answer.result().lights_size(), static_cast<int>(trackers.size()));
      for (size_t l = 0; l < trackers.size(); ++l) {
        const absl::StatusOr<TrackedPlan> want = trackers[l].Update(*surfaces);
        ASSERT_THAT(want, testing::IsOk());
        const v1::LightResult& light = answer.result().lights(static_cast<int>(l));
        EXPECT_EQ(light.plan().SerializeAsString(),
                  PlanToProto(want->plan, frames.lights[l], ClipConvention::Vulkan(), 0.0, true)
                      ->SerializeAsString());
        EXPECT_NEAR(light.energies().final(), want->plan.energy, 1e-9 * want->plan.energy);
        EXPECT_EQ(light.shot().plan().is_new(), want->is_new);
        ASSERT_EQ(light.shot().plan().maps_size(), static_cast<int>(want->actions.size()));
        for (size_t k = 0; k < want->actions.size(); ++k) {
          const v1::ShotMap& map = light.shot().plan().maps(static_cast<int>(k));
          EXPECT_EQ(map.action(), TrackerActionToProto(want->actions[k]));
          EXPECT_EQ(map.frames_kept(), want->frames_kept[k]);
          num_kept += map.frames_kept() > 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(num_kept, 3);
}

// A stream that broke goes on in another one, at another server, as if nothing had been.
TEST(PlanTrack, GoesOnFromWhatAnEarlierOneRemembered) {
  const Frames frames(5);
  TrackSession whole = Begun(SetupFor(0.5));
  v1::TrackResult last;
  for (int f = 0; f < 3; ++f) {
    last = whole.Update(frames.messages[f], frames.files[f].View(), {});
  }
  v1::TrackSetup setup = SetupFor(0.5);
  *setup.mutable_state() = last.result().shot().tracker_state();
  EXPECT_EQ(setup.state_size(), 2);
  TrackSession second = Begun(setup);
  for (int f = 3; f < 5; ++f) {
    const Readback readback = frames.files[f].View();
    EXPECT_EQ(second.Update(frames.messages[f], readback, {}).SerializeAsString(),
              whole.Update(frames.messages[f], readback, {}).SerializeAsString());
  }
}

TEST(PlanTrack, AFrameThatCannotBeUsedLeavesTheTrackerAsItWas) {
  const Frames frames(2);
  TrackSession one = Begun(SetupFor(0.5)), other = Begun(SetupFor(0.5));
  one.Update(frames.messages[0], frames.files[0].View(), {});
  other.Update(frames.messages[0], frames.files[0].View(), {});
  v1::TrackFrame unlit = frames.messages[1];
  unlit.clear_lights();
  EXPECT_EQ(one.Update(unlit, frames.files[1].View(), {}).status().code(), 3);
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(
      one.Update(frames.messages[1], frames.files[1].View(), stopped.get_token()).status().code(),
      static_cast<int>(absl::StatusCode::kCancelled));
  EXPECT_EQ(one.Update(frames.messages[1], frames.files[1].View(), {}).SerializeAsString(),
            other.Update(frames.messages[1], frames.files[1].View(), {}).SerializeAsString());
}

TEST(PlanTrack, ALightIsForgottenWhenAFrameIsWithoutIt) {
  const Frames frames(1);
  TrackSession session = Begun(SetupFor(0.5));
  const Readback readback = frames.files[0].View();
  session.Update(frames.messages[0], readback, {});
  v1::TrackFrame without = frames.messages[0];
  without.mutable_lights()->RemoveLast();
  const v1::TrackResult fewer = session.Update(without, readback, {});
  EXPECT_EQ(fewer.result().lights_size(), 1);
  EXPECT_FALSE(fewer.result().lights(0).shot().plan().is_new());
  const v1::TrackResult again = session.Update(frames.messages[0], readback, {});
  ASSERT_EQ(again.result().lights_size(), 2);
  EXPECT_FALSE(again.result().lights(0).shot().plan().is_new());
  EXPECT_EQ(again.result().lights(1).shot().plan().maps(0).action(), v1::TRACKER_ACTION_FIRST);
}

TEST(PlanTrack, RefusesSetupsThatMakeNoSense) {
  const auto state = [](v1::TrackSetup* setup) {
    v1::TrackedState& added = *setup->add_state();
    added.set_light("sun");
    v1::TrackedMap& map = *added.mutable_plan()->add_maps();
    map.set_width(64);
    map.set_height(64);
    for (int i = 0; i < 16; ++i) map.mutable_map_from_world()->add_m(i % 5 == 0 ? 1.0 : 0.0);
    return &added;
  };
  const auto map_of = [](v1::TrackedState* state) {
    return state->mutable_plan()->mutable_maps(0);
  };
  const std::vector<testing::BadInput<v1::TrackSetup>> bad = {
      {[](auto* s) { s->mutable_plan_options()->set_max_maps(33); }, "plan_options.max_maps = 33"},
      {[](auto* s) { s->mutable_map()->set_width(8); }, "map: does not go with plan_options"},
      {[](auto* s) { s->set_stability(1.5); }, "stability = 1.5, want 0 ... 1"},
      {[](auto* s) { s->mutable_tracker(); }, "tracker: is for one map"},
      {[](auto* s) { s->mutable_plan_tracker(); }, "plan_tracker.update_every_frames = 0"},
      {[](auto* s) {
         s->mutable_plan_tracker()->set_tolerance(std::numeric_limits<double>::infinity());
       },
       "plan_tracker.tolerance = inf"},
      {[](auto* s) {
         s->mutable_plan_tracker();
         s->clear_plan_options();
       },
       "plan_tracker: is for plans"},
      {[](auto* s) { s->add_state(); }, "state[0].plan.maps: 0 of them, want 1 ... 32"},
      {[&](auto* s) {
         for (int k = 0; k < 33; ++k) state(s)->mutable_plan()->add_maps();
       },
       "state: of 33 lights, want at most 32"},
      {[&](auto* s) {
         v1::TrackedPlan* plan = state(s)->mutable_plan();
         while (plan->maps_size() < 33) *plan->add_maps() = plan->maps(0);
       },
       "state[0].plan.maps: 33 of them"},
      {[&](auto* s) { map_of(state(s))->set_width(0); }, "state[0].plan.maps[0]: map = 0x64"},
      {[&](auto* s) { map_of(state(s))->clear_map_from_world(); },
       "state[0].plan.maps[0].map_from_world"},
      {[&](auto* s) { map_of(state(s))->set_frames_kept(-1); },
       "state[0].plan.maps[0].frames_kept = -1, want 0 or more"},
      {[&](auto* s) { state(s)->set_frames_since_update(std::numeric_limits<int64_t>::max()); },
       "state[0].frames_since_update"},
      {[&](auto* s) { state(s)->set_border(static_cast<v1::Border>(9)); }, "state[0].border = 9"},
  };
  testing::ExpectRefused(
      SetupFor(0.5), bad, [](const v1::TrackSetup& setup, const CallContext& context) {
        return TrackSession::Begin(setup, context.limits);
      });
  CallContext context;
  context.limits.max_maps = kMaxMaps - 1;
  EXPECT_EQ(TrackSession::Begin(SetupFor(0.5), context.limits).status().code(),
            absl::StatusCode::kResourceExhausted);
}

// What another server is said to have remembered may be anything.
TEST(PlanTrack, SurvivesWhateverStateComesIn) {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8 && y < 20; });
  const std::vector<Light> lights = {Light::Point("lamp", {1.0, 2.0, 5.0}, 0)};
  const auto frame = testing::RequestOf<v1::TrackFrame>(floor.View(), lights);
  const auto begin = [&](const v1::TrackSetup& setup, const CallContext& context) {
    absl::StatusOr<TrackSession> session = TrackSession::Begin(setup, context.limits);
    if (!session.ok()) return absl::StatusOr<v1::TrackResult>(session.status());
    return absl::StatusOr<v1::TrackResult>(session->Update(frame, floor.View(), {}));
  };
  v1::TrackSetup setup = SetupFor(0.5);
  setup.mutable_plan_options()->set_texels(4096);
  const absl::StatusOr<v1::TrackResult> first = begin(setup, CallContext());
  ASSERT_THAT(first, testing::IsOk());
  *setup.mutable_state() = first->result().shot().tracker_state();
  ASSERT_EQ(setup.state_size(), 1);
  testing::ExpectSurvivesMutations(
      setup,
      [&](const v1::TrackSetup& mutated, CallContext context) {
        context.limits.max_maps = kMaxMaps + 1;  // 32 are more work, and no more to survive
        return begin(mutated, context);
      },
      300);
}

// A matrix that is none of the light's is no plan to go on from.
TEST(PlanTrack, BeginsAnewWhereTheStateIsNoneOfTheLights) {
  const Frames frames(1);
  const Readback readback = frames.files[0].View();
  v1::TrackResult fresh = Begun(SetupFor(0.5)).Update(frames.messages[0], readback, {});
  v1::TrackSetup setup = SetupFor(0.5);
  *setup.mutable_state() = fresh.result().shot().tracker_state();
  for (v1::TrackedState& state : *setup.mutable_state()) {
    for (v1::TrackedMap& map : *state.mutable_plan()->mutable_maps()) {
      for (double& number : *map.mutable_map_from_world()->mutable_m()) number = 1.0;
    }
  }
  EXPECT_EQ(Begun(setup).Update(frames.messages[0], readback, {}).SerializeAsString(),
            fresh.SerializeAsString());
}

}  // namespace
}  // namespace lightfit
