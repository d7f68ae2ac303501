// An AsyncOptimizer under everything that an engine may do to it. Under the thread sanitizer these
// are what shows that the threads share nothing by accident.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <thread>
#include <vector>

#include "tests/testing/frame_loop.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::BoxWalk;
using testing::Fill;
using testing::PollLast;
using testing::Random;
using testing::StartOptimizer;
using testing::WaitUntilIdle;

// What comes back, looked at by whoever polls.
class Watcher {
 public:
  void Poll(AsyncOptimizer& optimizer) {
    const FrameMatrices* matrices = optimizer.Poll();
    if (matrices != nullptr) Look(*matrices);
  }

  void Look(const FrameMatrices& matrices) {
    ++num_polled_;
    EXPECT_GT(matrices.frame, last_frame_) << "frames only get newer";
    last_frame_ = matrices.frame;
    ASSERT_GE(matrices.num_lights, 0);
    ASSERT_LE(matrices.num_lights, kMaxLights);
    for (int i = 0; i < matrices.num_lights; ++i) {
      const FrameLight& light = matrices.lights[i];
      EXPECT_FALSE(light.name.empty());
      EXPECT_TRUE(light.map_from_world.allFinite()) << light.name;
      EXPECT_TRUE(std::isfinite(light.energy)) << light.name;
      if (light.status.ok()) {
        EXPECT_GT(light.map.width, 0) << light.name;
      } else {
        EXPECT_FALSE(light.status.message().empty()) << light.name;
      }
    }
  }

  int64_t last_frame() const { return last_frame_; }
  int64_t num_polled() const { return num_polled_; }

 private:
  int64_t last_frame_ = -1;
  int64_t num_polled_ = 0;
};

void ExpectCountsAddUp(const AsyncOptimizer::Counts& counts) {
  const int64_t rest = counts.submitted - counts.done - counts.skipped;
  EXPECT_GE(counts.done, 0);
  EXPECT_GE(counts.skipped, 0);
  EXPECT_GE(rest, 0);
}

TEST(AsyncStress, TenThousandFramesWith32Lights) {
  constexpr uint64_t kSeed = 31;
  constexpr int kNumFrames = 10'000, kFramesPerTurn = 100, kFramesWaitedFor = 5;
  const BoxWalk walk(kSeed, kMaxLights, /*num_views=*/4, 24, 24);
  // What is shared between the threads is looked at here: the fit itself is the quickest there is.
  TrackerOptions options = TrackerOptions::ForStability(1.0);
  options.update_every_frames = std::numeric_limits<int>::max();
  options.fit.search = Search::kFocused;
  options.fit.affine = Affine::kMinAreaRectangle;
  options.fit.metric = Metric::kL2;
  AsyncOptimizer optimizer = StartOptimizer(options);
  Watcher watcher;
  for (int frame = 0; frame < kNumFrames; ++frame) {
    Fill(walk.views[frame % 4], walk.lights, frame, &optimizer.Lend());
    optimizer.Submit();
    // In turns slower and faster than the optimizer.
    if (frame % kFramesPerTurn < kFramesWaitedFor) WaitUntilIdle(optimizer);
    watcher.Poll(optimizer);
  }
  WaitUntilIdle(optimizer);
  if (watcher.last_frame() < kNumFrames - 1) watcher.Look(PollLast(optimizer, kNumFrames - 1));
  const AsyncOptimizer::Counts counts = optimizer.counts();
  std::printf("seed %d: submitted %d, done %d, skipped %d, polled %d\n",
              static_cast<int>(kSeed),
              static_cast<int>(counts.submitted),
              static_cast<int>(counts.done),
              static_cast<int>(counts.skipped),
              static_cast<int>(watcher.num_polled()));
  EXPECT_EQ(counts.submitted, kNumFrames);
  EXPECT_EQ(counts.done + counts.skipped, kNumFrames);
  EXPECT_GE(counts.done, kNumFrames / kFramesPerTurn * kFramesWaitedFor);
  EXPECT_LE(watcher.num_polled(), counts.done);
  EXPECT_EQ(watcher.last_frame(), kNumFrames - 1);
}

// Frames with any of the lights, any size, now and then an error; options that change; pauses.
class Producer {
 public:
  Producer(Random& random, const std::vector<BoxWalk>& walks) : random_(random), walks_(walks) {}

  void SubmitFrame(AsyncOptimizer& optimizer) {
    const BoxWalk& walk = walks_[random_.Int(0, static_cast<int>(walks_.size()) - 1)];
    std::vector<Light> lights;
    const uint32_t which = random_.Bits() & random_.Bits();
    for (size_t i = 0; i < walk.lights.size(); ++i) {
      if ((which >> i & 1) != 0) lights.push_back(walk.lights[i]);
    }
    if (!lights.empty() && random_.Int(0, 9) == 0) lights.back().direction.setZero();
    const int view = random_.Int(0, static_cast<int>(walk.views.size()) - 1);
    FrameReadback& readback = optimizer.Lend();
    Fill(walk.views[view], lights, frame_++, &readback);
    readback.map = {256 << random_.Int(0, 1), 512};
    if (random_.Int(0, 19) == 0) readback.depth.resize(readback.depth.size() / 2);
    if (random_.Int(0, 19) == 0) readback.map.width = 0;
    if (random_.Int(0, 9) == 0) {
      const double stability = random_.Uniform(0.0, 1.0);
      EXPECT_TRUE(optimizer.SetOptions(TrackerOptions::ForStability(stability)).ok());
    }
    optimizer.Submit();
  }

  // Nothing, a moment, or until the optimizer sleeps.
  void Pause(const AsyncOptimizer& optimizer) {
    switch (random_.Int(0, 3)) {
      case 0:
        return WaitUntilIdle(optimizer);
      case 1:
        return std::this_thread::sleep_for(std::chrono::microseconds(random_.Int(1, 300)));
      default:
        return;
    }
  }

  int64_t num_submitted() const { return frame_; }

 private:
  Random& random_;
  const std::vector<BoxWalk>& walks_;
  int64_t frame_ = 0;
};

std::vector<BoxWalk> MakeWalks() {
  std::vector<BoxWalk> walks;
  walks.emplace_back(/*seed=*/41, kMaxLights, /*num_views=*/3, 24, 24);
  walks.emplace_back(/*seed=*/42, kMaxLights, /*num_views=*/3, 40, 16);
  return walks;
}

// Ends wherever the optimizer happens to be: asleep, at work, with a frame waiting.
TEST(AsyncStress, LightsComeAndGoAndItEndsAtAnyMoment) {
  const std::vector<BoxWalk> walks = MakeWalks();
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Producer producer(random, walks);
    Watcher watcher;
    AsyncOptimizer::Counts counts;
    {
      AsyncOptimizer optimizer = StartOptimizer();
      const int num_frames = random.Int(0, 40);
      for (int i = 0; i < num_frames; ++i) {
        producer.SubmitFrame(optimizer);
        producer.Pause(optimizer);
        if (random.Coin()) watcher.Poll(optimizer);
        ExpectCountsAddUp(optimizer.counts());
      }
      counts = optimizer.counts();
    }
    std::printf("seed %d: submitted %d, done %d, skipped %d, polled %d\n",
                static_cast<int>(seed),
                static_cast<int>(counts.submitted),
                static_cast<int>(counts.done),
                static_cast<int>(counts.skipped),
                static_cast<int>(watcher.num_polled()));
    EXPECT_EQ(counts.submitted, producer.num_submitted());
    EXPECT_LE(counts.submitted - counts.done - counts.skipped, 2) << "in work, and waiting";
    EXPECT_LE(watcher.num_polled(), counts.done + 1);
  }
}

// One thread submits, one polls, one counts.
TEST(AsyncStress, ThreadsOfTheirOwnSubmitPollAndCount) {
  const std::vector<BoxWalk> walks = MakeWalks();
  for (const uint64_t seed : {101, 102, 103}) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Producer producer(random, walks);
    Watcher watcher;
    AsyncOptimizer optimizer = StartOptimizer();
    std::atomic<bool> submitting = true;
    std::thread poller([&] {
      while (submitting.load()) {
        watcher.Poll(optimizer);
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      }
    });
    std::thread counter([&] {
      while (submitting.load()) {
        ExpectCountsAddUp(optimizer.counts());
        std::this_thread::sleep_for(std::chrono::microseconds(30));
      }
    });
    constexpr int kNumFrames = 25;
    for (int i = 0; i < kNumFrames; ++i) {
      producer.SubmitFrame(optimizer);
      producer.Pause(optimizer);
    }
    WaitUntilIdle(optimizer);
    submitting = false;
    poller.join();
    counter.join();
    if (watcher.last_frame() < kNumFrames - 1) watcher.Look(PollLast(optimizer, kNumFrames - 1));
    const AsyncOptimizer::Counts counts = optimizer.counts();
    std::printf("seed %d: done %d, skipped %d, polled %d\n",
                static_cast<int>(seed),
                static_cast<int>(counts.done),
                static_cast<int>(counts.skipped),
                static_cast<int>(watcher.num_polled()));
    EXPECT_EQ(counts.submitted, kNumFrames);
    EXPECT_EQ(counts.done + counts.skipped, kNumFrames);
    EXPECT_LE(watcher.num_polled(), counts.done);
  }
}

}  // namespace
}  // namespace lightfit
