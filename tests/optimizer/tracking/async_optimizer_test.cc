#include "optimizer/tracking/async_optimizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <stop_token>
#include <thread>
#include <utility>

#include "tests/testing/frame_loop.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::BoxWalk;
using testing::Fill;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PollLast;
using testing::StartOptimizer;
using testing::StatusIs;
using testing::WaitUntilIdle;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

bool SameBytes(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 16) == 0;
}

void ExpectSame(const FrameLight& light, const absl::StatusOr<TrackedMatrix>& expected) {
  ASSERT_EQ(light.status, expected.status()) << light.name;
  if (!expected.ok()) return;
  EXPECT_TRUE(SameBytes(light.map_from_world, expected->matrix.map_from_world)) << light.name;
  EXPECT_EQ(light.map.width, expected->matrix.map.width);
  EXPECT_EQ(light.map.height, expected->matrix.map.height);
  EXPECT_EQ(light.energy, expected->matrix.figures.energy);
  EXPECT_EQ(light.action, expected->action);
}

// One frame, from submission to matrices.
const FrameMatrices& RunFrame(AsyncOptimizer& optimizer,
                              const SyntheticReadback& view,
                              absl::Span<const Light> lights,
                              int64_t frame) {
  Fill(view, lights, frame, &optimizer.Lend());
  optimizer.Submit();
  return PollLast(optimizer, frame);
}

TEST(AsyncOptimizer, MatricesAreThoseOfTheTrackerWhateverChangesBetweenFrames) {
  constexpr uint64_t kSeed = 3;
  SCOPED_TRACE(kSeed);
  const BoxWalk small(kSeed, /*num_lights=*/4, /*num_views=*/4, 48, 32);
  const BoxWalk large(kSeed, /*num_lights=*/4, /*num_views=*/4, 80, 64);
  struct Change {
    const BoxWalk* walk;
    MapSize map;
    double stability;
    std::vector<int> lights;
  };
  const std::vector<Change> changes = {{&small, {1024, 1024}, 0.5, {0, 1, 2}},
                                       {&small, {1024, 1024}, 0.5, {0, 1, 2}},
                                       {&small, {1024, 1024}, 0.5, {2, 1}},
                                       {&large, {1024, 1024}, 0.5, {2, 1}},
                                       {&large, {512, 2048}, 0.5, {3, 2, 1, 0}},
                                       {&large, {512, 2048}, 0.0, {3, 2, 1, 0}},
                                       {&small, {512, 2048}, 1.0, {}},
                                       {&small, {512, 2048}, 1.0, {0, 1, 2, 3}}};
  AsyncOptimizer optimizer = StartOptimizer();
  Tracker tracker{TrackerOptions()};
  int64_t frame = 100;
  for (const Change& change : changes) {
    SCOPED_TRACE(frame);
    const SyntheticReadback& view = change.walk->views[frame % 4];
    std::vector<Light> lights;
    for (const int i : change.lights) lights.push_back(change.walk->lights[i]);
    const TrackerOptions options = TrackerOptions::ForStability(change.stability);
    ASSERT_THAT(optimizer.SetOptions(options), IsOk());
    FrameReadback& readback = optimizer.Lend();
    EXPECT_EQ(&readback, &optimizer.Lend());
    Fill(view, lights, frame, &readback);
    readback.map = change.map;
    optimizer.Submit();
    const FrameMatrices& matrices = PollLast(optimizer, frame);
    tracker.set_options(options);
    const auto expected = tracker.Update(view.View(), lights, change.map);
    ASSERT_EQ(matrices.num_lights, static_cast<int>(lights.size()));
    for (size_t i = 0; i < lights.size(); ++i) {
      EXPECT_EQ(matrices.lights[i].name, lights[i].name);
      EXPECT_EQ(matrices.Find(lights[i].name), &matrices.lights[i]);
      ExpectSame(matrices.lights[i], expected[i]);
    }
    EXPECT_EQ(matrices.Find("nobody"), nullptr);
    ++frame;
  }
}

// The same views with more pixels, in some of the frames.
TEST(AsyncOptimizer, AFinerCoverHasRoomAsInTheTracker) {
  constexpr uint64_t kSeed = 4;
  SCOPED_TRACE(kSeed);
  const BoxWalk walk(kSeed, /*num_lights=*/3, /*num_views=*/4, 32, 24);
  const BoxWalk fine(kSeed, /*num_lights=*/3, /*num_views=*/4, 128, 96);
  AsyncOptimizer optimizer = StartOptimizer();
  Tracker tracker{TrackerOptions()}, without{TrackerOptions()};
  int num_changed = 0;
  for (int64_t frame = 0; frame < 4; ++frame) {
    SCOPED_TRACE(frame);
    FrameReadback& readback = optimizer.Lend();
    Fill(walk.views[frame], walk.lights, frame, &readback);
    readback.fine_cover = FrameFineCover();
    if (frame != 2) testing::FillFineCover(fine.views[frame], &readback);
    FineCover cover;
    const auto expected = tracker.Update(readback.View(&cover), walk.lights, readback.map);
    const auto coarse = without.Update(readback.View(), walk.lights, readback.map);
    optimizer.Submit();
    const FrameMatrices& matrices = PollLast(optimizer, frame);
    for (size_t i = 0; i < walk.lights.size(); ++i) {
      ExpectSame(matrices.lights[i], expected[i]);
      if (!expected[i].ok() || !coarse[i].ok()) continue;
      num_changed +=
          SameBytes(expected[i]->matrix.map_from_world, coarse[i]->matrix.map_from_world) ? 0 : 1;
    }
  }
  EXPECT_GT(num_changed, 0);
  FrameReadback& readback = optimizer.Lend();
  Fill(walk.views[0], walk.lights, 9, &readback);
  testing::FillFineCover(fine.views[0], &readback);
  readback.fine_cover.nearest.pop_back();
  optimizer.Submit();
  EXPECT_THAT(PollLast(optimizer, 9).lights[0].status,
              StatusIs(kInvalid, HasSubstr("readback.fine_cover.nearest")));
}

TEST(AsyncOptimizer, LightThatVanishedComesBackAsNew) {
  const BoxWalk walk(/*seed=*/5, /*num_lights=*/2, /*num_views=*/1, 64, 64);
  AsyncOptimizer optimizer = StartOptimizer(TrackerOptions::ForStability(1.0));
  const Light& sun = walk.lights[0];
  const absl::Span<const Light> both = walk.lights, lamp = both.subspan(1);
  EXPECT_EQ(RunFrame(optimizer, walk.views[0], both, 1).Find(sun.name)->action,
            TrackerAction::kFirst);
  EXPECT_EQ(RunFrame(optimizer, walk.views[0], both, 2).Find(sun.name)->action,
            TrackerAction::kKept);
  EXPECT_EQ(RunFrame(optimizer, walk.views[0], lamp, 3).Find(sun.name), nullptr);
  EXPECT_EQ(RunFrame(optimizer, walk.views[0], both, 4).Find(sun.name)->action,
            TrackerAction::kFirst);
}

TEST(AsyncOptimizer, SkipsFramesWhileBusyAndEndsWithTheNewest) {
  const BoxWalk walk(/*seed=*/7, kMaxLights, /*num_views=*/4, 64, 48);
  AsyncOptimizer optimizer = StartOptimizer();
  constexpr int kLast = 50;
  for (int frame = 1; frame <= kLast; ++frame) {
    Fill(walk.views[frame % 4], walk.lights, frame, &optimizer.Lend());
    optimizer.Submit();
  }
  WaitUntilIdle(optimizer);
  const AsyncOptimizer::Counts counts = optimizer.counts();
  EXPECT_EQ(counts.submitted, kLast);
  EXPECT_EQ(counts.done + counts.skipped, kLast);
  EXPECT_GE(counts.done, 1);
  EXPECT_GT(counts.skipped, 0) << "50 frames written sooner than 50 * 32 lights are fitted";
  EXPECT_EQ(PollLast(optimizer, kLast).num_lights, kMaxLights);
}

TEST(AsyncOptimizer, PolledMatricesStayUntilOthersArePolled) {
  const BoxWalk walk(/*seed=*/9, /*num_lights=*/2, /*num_views=*/4, 48, 48);
  AsyncOptimizer optimizer = StartOptimizer(TrackerOptions::ForStability(0.0));
  EXPECT_EQ(optimizer.Poll(), nullptr);
  const FrameMatrices& polled = RunFrame(optimizer, walk.views[0], walk.lights, 1);
  const Eigen::Matrix4d map_from_world = polled.lights[0].map_from_world;
  EXPECT_EQ(optimizer.Poll(), nullptr);
  for (int frame = 2; frame <= 4; ++frame) {
    Fill(walk.views[frame - 1], walk.lights, frame, &optimizer.Lend());
    optimizer.Submit();
    WaitUntilIdle(optimizer);
  }
  EXPECT_EQ(polled.frame, 1);
  EXPECT_TRUE(SameBytes(polled.lights[0].map_from_world, map_from_world));
  const FrameMatrices& newest = PollLast(optimizer, 4);
  EXPECT_FALSE(SameBytes(newest.lights[0].map_from_world, map_from_world));
}

TEST(AsyncOptimizer, ReadbackThatCannotBeUsedIsTheStatusOfItsLights) {
  const BoxWalk walk(/*seed=*/11, /*num_lights=*/3, /*num_views=*/1, 48, 48);
  AsyncOptimizer optimizer = StartOptimizer();
  FrameReadback& readback = optimizer.Lend();
  Fill(walk.views[0], walk.lights, 1, &readback);
  readback.depth.pop_back();
  optimizer.Submit();
  const FrameMatrices& wrong = PollLast(optimizer, 1);
  ASSERT_EQ(wrong.num_lights, 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(wrong.lights[i].status, StatusIs(kInvalid, HasSubstr("depth")));
    EXPECT_EQ(wrong.lights[i].name, walk.lights[i].name);
  }
  const FrameMatrices& right = RunFrame(optimizer, walk.views[0], walk.lights, 2);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(right.lights[i].status, IsOk());
}

TEST(AsyncOptimizer, OneLightsErrorLeavesTheOthersAndItsOwnMatrixBlank) {
  const BoxWalk walk(/*seed=*/11, /*num_lights=*/3, /*num_views=*/1, 48, 48);
  AsyncOptimizer optimizer = StartOptimizer();
  for (int frame = 1; frame <= 3; ++frame) RunFrame(optimizer, walk.views[0], walk.lights, frame);
  std::vector<Light> lights = walk.lights;
  lights[1] = Light::Directional("broken", Eigen::Vector3d::Zero(), 1);
  const FrameMatrices& matrices = RunFrame(optimizer, walk.views[0], lights, 4);
  EXPECT_THAT(matrices.lights[0].status, IsOk());
  EXPECT_THAT(matrices.lights[1].status, StatusIs(kInvalid, HasSubstr("light \"broken\"")));
  EXPECT_TRUE(SameBytes(matrices.lights[1].map_from_world, Eigen::Matrix4d::Identity()));
  EXPECT_THAT(matrices.lights[2].status, IsOk());
}

TEST(AsyncOptimizer, MoreLightsThanShadowBitsAreRefused) {
  const BoxWalk walk(/*seed=*/13, kMaxLights, /*num_views=*/1, 32, 32);
  std::vector<Light> lights = walk.lights;
  lights.push_back(lights.front());
  AsyncOptimizer optimizer = StartOptimizer();
  const FrameMatrices& matrices = RunFrame(optimizer, walk.views[0], lights, 1);
  ASSERT_EQ(matrices.num_lights, kMaxLights);
  for (const FrameLight& light : matrices.lights) {
    EXPECT_THAT(light.status, StatusIs(kInvalid, HasSubstr("33 of them, want at most 32")));
  }
}

TEST(AsyncOptimizer, OptionsThatCannotBeUsedAreRefusedAndLeaveThoseBefore) {
  TrackerOptions wrong;
  wrong.update_every_frames = 0;
  EXPECT_THAT(AsyncOptimizer::Start(wrong), StatusIs(kInvalid, HasSubstr("update_every_frames")));
  const BoxWalk walk(/*seed=*/15, /*num_lights=*/1, /*num_views=*/1, 48, 48);
  AsyncOptimizer optimizer = StartOptimizer();
  EXPECT_THAT(optimizer.SetOptions(wrong), StatusIs(kInvalid, HasSubstr("update_every_frames")));
  EXPECT_THAT(RunFrame(optimizer, walk.views[0], walk.lights, 1).lights[0].status, IsOk());
}

TEST(AsyncOptimizer, WakesUpAndEndsAfterALongPause) {
  constexpr auto kPause = std::chrono::milliseconds(250);  // it stops looking for frames sooner
  const BoxWalk walk(/*seed=*/19, /*num_lights=*/2, /*num_views=*/3, 48, 48);
  AsyncOptimizer optimizer = StartOptimizer();
  for (int frame = 1; frame <= 3; ++frame) {
    std::this_thread::sleep_for(kPause);
    EXPECT_EQ(RunFrame(optimizer, walk.views[frame - 1], walk.lights, frame).num_lights, 2);
  }
  std::this_thread::sleep_for(kPause);
}

TEST(AsyncOptimizer, EndsInTheMiddleOfAFrameThatWouldTakeHours) {
  const BoxWalk walk(/*seed=*/23, /*num_lights=*/2, /*num_views=*/1, 48, 48);
  TrackerOptions options;
  options.fit.grid_directions = 1'000'000'000;
  for (const int milliseconds : {0, 1, 10, 100}) {
    AsyncOptimizer optimizer = StartOptimizer(options);
    Fill(walk.views[0], walk.lights, 1, &optimizer.Lend());
    optimizer.Submit();
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    EXPECT_EQ(optimizer.counts().done, 0);
    EXPECT_EQ(optimizer.Poll(), nullptr);
  }
}

TEST(AsyncOptimizer, StopScopesOfItsCallersDoNotReachIt) {
  const BoxWalk walk(/*seed=*/25, /*num_lights=*/1, /*num_views=*/1, 48, 48);
  std::stop_source stopped;
  stopped.request_stop();
  const StopScope stop_scope(stopped.get_token());
  AsyncOptimizer optimizer = StartOptimizer(TrackerOptions());
  EXPECT_THAT(RunFrame(optimizer, walk.views[0], walk.lights, 1).lights[0].status, IsOk());
}

TEST(AsyncOptimizer, EndsAtAnyMomentAndCanBeMovedWhileItWorks) {
  const BoxWalk walk(/*seed=*/17, kMaxLights, /*num_views=*/2, 48, 48);
  const auto submit = [&](AsyncOptimizer& optimizer, int num_frames) {
    for (int frame = 1; frame <= num_frames; ++frame) {
      Fill(walk.views[frame % 2], walk.lights, frame, &optimizer.Lend());
      optimizer.Submit();
    }
  };
  for (int num_frames = 0; num_frames <= 3; ++num_frames) {
    AsyncOptimizer optimizer = StartOptimizer();
    submit(optimizer, num_frames);
  }
  AsyncOptimizer first = StartOptimizer(), second = StartOptimizer();
  submit(first, 1);
  submit(second, 3);
  second = std::move(first);  // ends what was there
  EXPECT_EQ(PollLast(second, 1).num_lights, kMaxLights);
}

}  // namespace
}  // namespace lightfit
