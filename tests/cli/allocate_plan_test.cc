// `lightfit allocate --maps`: a budget divided among lights and their maps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "partition/plan.h"
#include "tests/cli/allocations.h"
#include "tests/cli/examples.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"
#include "wire/plan_proto.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;

constexpr int64_t kBudget = 600 * 600;

TEST(AllocatePlans, DividesABudgetAmongLightsAndMaps) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  const ProcessResult run =
      AllocateYard({"--budget", "600x600", "--maps", "3", "--json", json, "--legend"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, HasSubstr("plans of equal"));
  const v1::Allocation allocation = ReadAllocation(json);
  EXPECT_EQ(allocation.plan_options().max_maps(), 3);
  EXPECT_LE(allocation.texels(), kBudget);
  EXPECT_GT(allocation.texels(), 0.97 * kBudget);
  int64_t texels = 0;
  for (int i = 0; i < allocation.lights_size(); ++i) {
    const absl::StatusOr<Plan> plan = PlanFromProto(allocation.lights(i).plan(), "plan");
    ASSERT_THAT(plan, IsOk());
    EXPECT_EQ(allocation.maps(i).texels(), NumTexels(*plan));
    texels += NumTexels(*plan);
  }
  EXPECT_EQ(texels, allocation.texels());
}

TEST(AllocatePlans, TakesAllowedSizes) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  const ProcessResult run = AllocateYard(
      {"--budget", "600x600", "--maps", "2", "--power-of-two", "--min-side", "32", "--json", json});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const v1::Allocation allocation = ReadAllocation(json);
  EXPECT_LE(allocation.texels(), kBudget);
  EXPECT_TRUE(allocation.plan_options().sizes().powers_of_two());
  for (const v1::LightResult& light : allocation.lights()) {
    EXPECT_GT(light.plan().maps_size(), 0);
    for (const v1::PlanMap& map : light.plan().maps()) {
      for (const int side : {map.map().width(), map.map().height()}) {
        EXPECT_GE(side, 32);
        EXPECT_EQ(side & (side - 1), 0) << side;
      }
    }
  }
}

TEST(AllocatePlans, NeedsLessEnergyThanEqualSharesOnEveryReadback) {
  const std::string folder = RepositoryPath("../shared/readbacks");
  int num_readbacks = 0;
  for (const char* set : {"yard_180", "room_180", "room_180_facing", "hall_180", "shot_walk"}) {
    const std::string readback = folder + "/" + set + "/0001.exr";
    if (!std::filesystem::exists(readback)) continue;
    const TemporaryFolder output;
    const std::string json = output.Path("maps.json");
    const ProcessResult run = RunLightfit({"allocate",
                                           readback,
                                           "--lights",
                                           folder + "/" + set + "/scene.json",
                                           "--budget",
                                           "1024x1024",
                                           "--maps",
                                           "4",
                                           "--quiet",
                                           "--json",
                                           json});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const v1::Allocation allocation = ReadAllocation(json);
    double energy = 0.0, equal = 0.0;
    for (int i = 0; i < allocation.lights_size(); ++i) {
      energy += allocation.lights(i).energies().final();
      equal += allocation.maps(i).equal_split_energy();
    }
    EXPECT_LT(energy, equal) << set;
    ++num_readbacks;
  }
  if (num_readbacks == 0) GTEST_SKIP() << folder << " is not here";
}

TEST(AllocatePlans, SaysWhatDoesNotGoWithPlans) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--tolerance", "rms:1"},
                                               {"--budget", "600x600", "--affine", "rectangle"},
                                               {"--budget", "600x600", "--search", "focused"}}) {
    std::vector<std::string> arguments = more;
    arguments.insert(arguments.end(), {"--maps", "2"});
    const ProcessResult run = AllocateYard(arguments);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.err, HasSubstr("--maps"));
  }
  const ProcessResult run = AllocateYard({"--budget", "600x600", "--guard", "2"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("--maps 2 or more"));
}

}  // namespace
}  // namespace lightfit
