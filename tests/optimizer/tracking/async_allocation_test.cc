// The frame loop takes nothing from the heap once it has seen the work, in either thread.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/testing/allocation_counter.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::BoxWalk;
using testing::Fill;
using testing::NumAllocations;
using testing::StartOptimizer;
using testing::WaitUntilIdle;

TEST(AsyncAllocation, NothingIsAllocatedAfterTheFirstFrames) {
  const BoxWalk walk(/*seed=*/21, /*num_lights=*/8, /*num_views=*/4, 48, 48);
  const BoxWalk fine(/*seed=*/21, /*num_lights=*/8, /*num_views=*/4, 96, 96);
  AsyncOptimizer optimizer = StartOptimizer();
  int64_t frame = 0, num_polled = 0, num_failed = 0;
  // Waits for every frame, so that all buffers get their turn, then hurries, so that some are
  // skipped.
  const auto run = [&](int num_frames, bool waits) {
    for (int i = 0; i < num_frames; ++i, ++frame) {
      Fill(walk.views[frame % 4], walk.lights, frame, &optimizer.Lend());
      testing::FillFineCover(fine.views[frame % 4], &optimizer.Lend());
      if (!optimizer.SetOptions({}).ok()) ++num_failed;
      optimizer.Submit();
      if (waits) WaitUntilIdle(optimizer);
      const FrameMatrices* matrices = optimizer.Poll();
      if (matrices == nullptr) continue;
      ++num_polled;
      for (const Light& light : walk.lights) {
        const FrameLight* found = matrices->Find(light.name);
        if (found == nullptr || !found->status.ok()) ++num_failed;
      }
    }
    WaitUntilIdle(optimizer);
  };
  const auto warm_up = [&] {
    run(24, /*waits=*/true);
    run(24, /*waits=*/false);
  };
  warm_up();
  const int64_t before = NumAllocations();
  warm_up();
  EXPECT_EQ(NumAllocations() - before, 0);
  EXPECT_EQ(num_failed, 0);
  EXPECT_GT(num_polled, 0);
}

}  // namespace
}  // namespace lightfit
