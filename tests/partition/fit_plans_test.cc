#include "partition/fit_plans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr int64_t kTexels = 3 * 160 * 160;

std::vector<PlannedLight> Planned(const std::vector<Light>& lights) {
  std::vector<PlannedLight> planned;
  for (const Light& light : lights) planned.push_back({light});
  return planned;
}

PlanOptions OptionsOf(int64_t texels) {
  PlanOptions options;
  options.max_maps = 3;
  options.texels = texels;
  options.choose_by_forecast = false;
  return options;
}

// Rounding to whole texels, and cells that come out otherwise, may take a little of what dividing
// gains: where the lights are alike that is all there is.
TEST(FitPlans, LessEnergyThanEqualSharesOfTheSameBudget) {
  constexpr double kRounding = 1.02;
  double sum = 0.0, sum_equal = 0.0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const TestScene scene(seed, 3, 120, 90);
    const auto surfaces = FindSurfaces(scene.View(), 0x7, {});
    ASSERT_THAT(surfaces, IsOk());
    const LightPlans plans = FitPlans(*surfaces, Planned(scene.lights), OptionsOf(kTexels));
    double energy = 0.0, equal = 0.0;
    int64_t texels = 0;
    for (size_t i = 0; i < plans.size(); ++i) {
      ASSERT_THAT(plans[i], IsOk());
      energy += plans[i]->energy;
      texels += NumTexels(PlanOf(*plans[i]));
      equal += FitPlan(*surfaces, scene.lights[i], OptionsOf(kTexels / 3))->energy;
    }
    EXPECT_LE(texels, kTexels);
    EXPECT_LT(energy, kRounding * equal) << "seed " << seed;
    sum += energy;
    sum_equal += equal;
  }
  std::printf("%.3f of equal shares\n", sum / sum_equal);
  EXPECT_LT(sum, 0.98 * sum_equal);
}

TEST(FitPlans, ALightThatCountsMoreGetsMore) {
  const TestScene scene(2, 3, 120, 90);
  const auto surfaces = FindSurfaces(scene.View(), 0x7, {});
  ASSERT_THAT(surfaces, IsOk());
  std::vector<PlannedLight> lights = Planned(scene.lights);
  const LightPlans before = FitPlans(*surfaces, lights, OptionsOf(kTexels));
  lights[1].weight = 10.0;
  const LightPlans after = FitPlans(*surfaces, lights, OptionsOf(kTexels));
  EXPECT_GT(NumTexels(PlanOf(*after[1])), NumTexels(PlanOf(*before[1])));
  EXPECT_LT(NumTexels(PlanOf(*after[0])), NumTexels(PlanOf(*before[0])));
}

TEST(FitPlans, ALightWithoutAPlanLeavesItsTexelsToTheOthers) {
  const TestScene scene(2, 2, 120, 90);
  const auto surfaces = FindSurfaces(scene.View(), 0x3, {});
  ASSERT_THAT(surfaces, IsOk());
  std::vector<PlannedLight> lights = Planned(scene.lights);
  lights.push_back({Light::Directional("none", {0.0, 0.0, 0.0})});
  const LightPlans plans = FitPlans(*surfaces, lights, OptionsOf(kTexels));
  EXPECT_THAT(plans[2], StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("none")));
  const int64_t texels = NumTexels(PlanOf(*plans[0])) + NumTexels(PlanOf(*plans[1]));
  EXPECT_LE(texels, kTexels);
  EXPECT_GT(texels, kTexels * 9 / 10);
}

TEST(FitPlans, SaysWhatIsWrong) {
  const TestScene scene(2, 1, 120, 90);
  const auto surfaces = FindSurfaces(scene.View(), 0x1, {});
  ASSERT_THAT(surfaces, IsOk());
  EXPECT_TRUE(FitPlans(*surfaces, {}, OptionsOf(kTexels)).empty());
  std::vector<PlannedLight> lights = Planned(scene.lights);
  lights[0].weight = -1.0;
  EXPECT_THAT(FitPlans(*surfaces, lights, OptionsOf(kTexels))[0],
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("weight = -1")));
  lights[0].weight = 1.0;
  EXPECT_THAT(FitPlans(*surfaces, lights, OptionsOf(5))[0],
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("texels = 5")));
}

}  // namespace
}  // namespace lightfit
