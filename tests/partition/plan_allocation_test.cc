// A frame loop's plans take nothing from the heap once their pool has seen the work.
#include <gtest/gtest.h>

#include <cstdio>

#include "base/scratch.h"
#include "partition/fit_plan.h"
#include "tests/testing/allocation_counter.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::NumAllocations;
using testing::TestScene;

TEST(FitPlan, AllocatesNothingFromAWarmPool) {
  constexpr int kNumRounds = 4;
  for (const uint64_t seed : {1}) {
    std::printf("[   seed   ] %d\n", static_cast<int>(seed));
    const TestScene scene(seed, 3, 96, 64);
    const Readback readback = scene.readback.ViewWithFacing();
    PlanOptions options;
    options.max_maps = 4;
    for (const bool choose : {false, true}) {
      options.choose_by_forecast = choose;
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
          EXPECT_EQ(NumAllocations() - before, 0) << "seed " << seed << ", round " << round;
        }
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
