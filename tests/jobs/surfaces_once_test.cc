// The pass over all pixels is made once for a read-back, whatever is asked of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "jobs/allocate_lights.h"
#include "jobs/fit_comparison.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::TestScene;

constexpr int kNumLights = 4;

TEST(SurfacesOnce, InAFitOfAllLightsThreeWays) {
  const TestScene scene(/*seed=*/7, kNumLights);
  const std::vector<absl::Status> all_ok(kNumLights);
  for (const FitOptions& options : {FitOptions(), FitOptions::AsPublished()}) {
    const int64_t before = NumSurfacesFound();
    int num_begun = 0;
    const ComparedReadback compared =
        CompareLights(scene.View(), scene.lights, all_ok, {256, 256}, options, [&](const Light&) {
          ++num_begun;
        });
    EXPECT_EQ(NumSurfacesFound() - before, 1);
    EXPECT_EQ(num_begun, kNumLights);
    EXPECT_EQ(compared.comparisons.size(), size_t{kNumLights});
  }
}

TEST(SurfacesOnce, InAnAllocationByBudgetAndByTolerance) {
  const TestScene scene(/*seed=*/7, kNumLights);
  AllocationTask task;
  task.lights = scene.lights;
  task.readback = scene.View();
  task.light_status.resize(kNumLights);
  task.weights.assign(kNumLights, 1.0);
  const auto nothing = [](const std::string&) {};
  for (const bool by_budget : {true, false}) {
    task.budget_texels.reset();
    task.tolerance.reset();
    if (by_budget) {
      task.budget_texels = 1 << 20;
    } else {
      task.tolerance = Tolerance{Tolerance::Kind::kRms, 2.0, 1.0};
    }
    const int64_t before = NumSurfacesFound();
    ASSERT_THAT(AllocateLights(task, nothing), IsOk());
    EXPECT_EQ(NumSurfacesFound() - before, 1);
  }
}

}  // namespace
}  // namespace lightfit
