#include "calls/track_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "optimizer/tracking/tracker.h"
#include "tests/calls/requests.h"
#include "tests/io/summary_examples.h"
#include "wire/matrix_proto.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::kMap;
using testing::Yard;

v1::TrackSetup SetupFor(double stability) {
  v1::TrackSetup setup;
  setup.mutable_map()->set_width(kMap.width);
  setup.mutable_map()->set_height(kMap.height);
  setup.set_stability(stability);
  return setup;
}

// Frames that see different parts of the yard.
struct Frames {
  std::vector<ReadbackFile> files;
  std::vector<v1::TrackFrame> messages;

  explicit Frames(int count) {
    for (int i = 0; i < count; ++i) {
      files.push_back(testing::FrameOfYard(i));
      auto frame = testing::RequestOf<v1::TrackFrame>(files.back().View(), Yard().lights);
      frame.set_number(100 + i);
      messages.push_back(std::move(frame));
    }
  }
};

TEST(TrackSession, DoesWhatTheTrackerDoes) {
  const Frames frames(6);
  for (const double stability : {0.0, 0.5, 1.0}) {
    Tracker tracker(TrackerOptions::ForStability(stability));
    auto session = TrackSession::Begin(SetupFor(stability));
    ASSERT_THAT(session, testing::IsOk());
    for (size_t f = 0; f < frames.files.size(); ++f) {
      const Readback readback = frames.files[f].View();
      const TrackedMatrices want = tracker.Update(readback, Yard().lights, kMap);
      const v1::TrackResult answer = session->Update(frames.messages[f], readback, {});
      EXPECT_EQ(answer.number(), 100 + static_cast<int>(f));
      EXPECT_EQ(answer.status().code(), 0) << answer.status().message();
      ASSERT_EQ(answer.result().lights_size(), static_cast<int>(want.size()));
      for (size_t i = 0; i < want.size(); ++i) {
        const v1::LightResult& light = answer.result().lights(static_cast<int>(i));
        ASSERT_EQ(light.status().code(), static_cast<int>(want[i].status().code()));
        if (!want[i].ok()) continue;
        EXPECT_EQ(*MatrixFromProto(light.map_from_world(), "m"), want[i]->matrix.map_from_world);
        EXPECT_EQ(light.shot().action(), TrackerActionToProto(want[i]->action));
        EXPECT_EQ(light.shot().frames_kept(), want[i]->frames_kept);
      }
    }
  }
}

// A stream that broke goes on in another one, at another server, as if nothing had been.
TEST(TrackSession, GoesOnFromWhatAnEarlierOneRemembered) {
  const Frames frames(5);
  auto whole = TrackSession::Begin(SetupFor(0.5));
  ASSERT_THAT(whole, testing::IsOk());
  v1::TrackResult last;
  for (int f = 0; f < 3; ++f) {
    last = whole->Update(frames.messages[f], frames.files[f].View(), {});
  }
  v1::TrackSetup setup = SetupFor(0.5);
  *setup.mutable_state() = last.result().shot().tracker_state();
  auto second = TrackSession::Begin(setup);
  ASSERT_THAT(second, testing::IsOk());
  for (int f = 3; f < 5; ++f) {
    const Readback readback = frames.files[f].View();
    EXPECT_EQ(second->Update(frames.messages[f], readback, {}).SerializeAsString(),
              whole->Update(frames.messages[f], readback, {}).SerializeAsString());
  }
}

TEST(TrackSession, AFrameThatCannotBeUsedLeavesTheTrackerAsItWas) {
  const Frames frames(2);
  auto one = TrackSession::Begin(SetupFor(0.5)), other = TrackSession::Begin(SetupFor(0.5));
  ASSERT_THAT(one, testing::IsOk());
  ASSERT_THAT(other, testing::IsOk());
  one->Update(frames.messages[0], frames.files[0].View(), {});
  other->Update(frames.messages[0], frames.files[0].View(), {});

  const v1::TrackResult without =
      one->Update(frames.messages[1], absl::InvalidArgumentError("no pixels"), {});
  EXPECT_EQ(without.number(), 101);
  EXPECT_EQ(without.status().code(), 3);
  EXPECT_EQ(without.status().message(), "no pixels");
  v1::TrackFrame unlit = frames.messages[1];
  unlit.clear_lights();
  EXPECT_EQ(one->Update(unlit, frames.files[1].View(), {}).status().code(), 3);
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(
      one->Update(frames.messages[1], frames.files[1].View(), stopped.get_token()).status().code(),
      static_cast<int>(absl::StatusCode::kCancelled));

  EXPECT_EQ(one->Update(frames.messages[1], frames.files[1].View(), {}).SerializeAsString(),
            other->Update(frames.messages[1], frames.files[1].View(), {}).SerializeAsString());
}

TEST(TrackSession, RefusesSetupsThatMakeNoSense) {
  const std::vector<testing::BadInput<v1::TrackSetup>> bad = {
      {[](auto* s) { s->clear_map(); }, "map = 0x0"},
      {[](auto* s) { s->set_stability(1.5); }, "stability = 1.5, want 0 ... 1"},
      {[](auto* s) { s->set_stability(std::numeric_limits<double>::quiet_NaN()); }, "stability"},
      {[](auto* s) { s->mutable_tracker(); }, "tracker.keeps = 0"},
      {[](auto* s) {
         s->mutable_tracker()->set_keeps(v1::TRACKER_KEEPS_MATRIX);
         s->mutable_tracker()->set_replace_below(std::numeric_limits<double>::infinity());
       },
       "tracker.replace_below = inf"},
      {[](auto* s) { s->mutable_options()->set_min_w(7.0); }, "min_w"},
      {[](auto* s) { s->mutable_clip(); }, "clip"},
      {[](auto* s) { s->add_state(); }, "state[0].map_from_world"},
      {[](auto* s) {
         for (int i = 0; i < 33; ++i) s->add_state();
       },
       "state: of 33 lights, want at most 32"},
  };
  testing::ExpectRefused(
      SetupFor(0.5), bad, [](const v1::TrackSetup& setup, const CallContext& /*context*/) {
        return TrackSession::Begin(setup);
      });
}

}  // namespace
}  // namespace lightfit
