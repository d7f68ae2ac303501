// `lightfit summarize` and `lightfit fit --summary` end to end: a whole shot summed on a farm.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr uint32_t kSeed = 20240611;
constexpr double kSearchTolerance = 1e-5;  // of energies, where the search is let end

class SummarizeShot : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "no read-backs at " << folder_;
  }

  std::string Frame(int number) const { return absl::StrFormat("%s/%04d.exr", folder_, number); }
  std::string Lights() const { return folder_ + "/scene.json"; }

  static constexpr int kNumFrames = 24;
  const std::string folder_ = RepositoryPath("../shared/readbacks/shot_walk");
};

// Summarised one by one, then added in random groups, some of them with read-backs: what comes out
// is the same file, the same matrices, and the library's own sum.
TEST_F(SummarizeShot, SameBytesInAnyOrderAndGrouping) {
  const TemporaryFolder folder;
  const std::string sum = folder.Path("shot.summary"), json = folder.Path("shot.json");
  std::vector<std::string> singles;
  for (int i = 1; i <= kNumFrames; ++i) {
    singles.push_back(folder.Path(absl::StrCat(i, ".summary")));
    RunSummarize({Frame(i), "--lights", Lights(), "-o", singles.back()});
  }
  Arguments all = {"-o", sum, "--lights", Lights()};
  for (int i = 1; i <= kNumFrames; ++i) all.push_back(Frame(i));
  RunSummarize(all);
  ASSERT_EQ(RunLightfit({"fit", "--summary", sum, "--json", json}).exit_code, 0);
  const std::string expected_sum = ReadFile(sum), expected_json = ReadFile(json);
  ASSERT_FALSE(expected_json.empty());

  for (uint32_t seed = kSeed; seed < kSeed + 2; ++seed) {
    std::cout << "seed " << seed << std::endl;  // flushed: the program is forked off
    std::mt19937 random(seed);
    std::vector<std::string> parts;
    for (int i = 1; i <= kNumFrames; ++i) {
      parts.push_back(random() % 4 == 0 ? Frame(i) : singles[i - 1]);
    }
    for (int round = 0; parts.size() > 1; ++round) {
      std::shuffle(parts.begin(), parts.end(), random);
      const size_t count = std::min<size_t>(parts.size(), 4 + random() % 12);
      const bool is_last = count == parts.size();
      const std::string part =
          is_last ? sum : folder.Path(absl::StrCat(seed, "_", round, ".summary"));
      Arguments arguments(parts.end() - static_cast<std::ptrdiff_t>(count), parts.end());
      RunSummarize(Joined(arguments, {"--lights", Lights(), "-o", part}));
      parts.resize(parts.size() - count);
      parts.push_back(part);
    }
    EXPECT_TRUE(ReadFile(sum) == expected_sum);
    ASSERT_EQ(RunLightfit({"fit", "--summary", sum, "--json", json}).exit_code, 0);
    EXPECT_TRUE(ReadFile(json) == expected_json);
  }
}

TEST_F(SummarizeShot, MatricesAreThoseOfTheLibrarysSum) {
  const TemporaryFolder folder;
  const std::string sum = folder.Path("shot.summary"), json = folder.Path("shot.json");
  const absl::StatusOr<std::vector<Light>> lights = ReadLightsFile(Lights());
  ASSERT_TRUE(lights.ok()) << lights.status();
  Arguments all = {"-o", sum, "--lights", Lights()};
  std::vector<std::vector<Summary>> summaries(lights->size());
  for (int i = 1; i <= kNumFrames; ++i) {
    all.push_back(Frame(i));
    const absl::StatusOr<ReadbackFile> file = ReadReadbackExr(Frame(i), *lights);
    ASSERT_TRUE(file.ok()) << file.status();
    for (size_t l = 0; l < lights->size(); ++l) {
      const absl::StatusOr<Summary> summary = lightfit::Summarize(file->View(), (*lights)[l]);
      ASSERT_TRUE(summary.ok()) << summary.status();
      summaries[l].push_back(*summary);
    }
  }
  RunSummarize(all);
  ASSERT_EQ(RunLightfit({"fit", "--summary", sum, "--json", json}).exit_code, 0);
  const v1::FitResult result = ReadResult(json);
  ASSERT_EQ(result.lights_size(), static_cast<int>(lights->size()));
  for (const v1::LightResult& light : result.lights()) {
    const auto same = [&light](const Light& other) { return other.name == light.name(); };
    const size_t l = std::find_if(lights->begin(), lights->end(), same) - lights->begin();
    ASSERT_LT(l, lights->size());
    const absl::StatusOr<Summary> merged = MergeSummaries(summaries[l], (*lights)[l]);
    ASSERT_TRUE(merged.ok()) << merged.status();
    FitOptions options;
    options.compute_statistics = false;
    const absl::StatusOr<LightMatrix> fit = Fit(*merged, (*lights)[l], {1024, 1024}, options);
    ASSERT_TRUE(fit.ok()) << fit.status();
    EXPECT_EQ(MatrixOf(light.map_from_world()), fit->map_from_world);
    EXPECT_EQ(light.energies().final(), fit->figures.energy);
    EXPECT_EQ(light.samples().used(), fit->figures.samples.used);
  }
}

// Weighed once more, in the shot's own map, the bound on the sum of footprints falls to where it
// belongs to that map.
TEST_F(SummarizeShot, WeighingByTheFirstRoundLowersTheBound) {
  const TemporaryFolder folder;
  const std::string first = folder.Path("1.json"), second = folder.Path("2.json");
  const std::string sum = folder.Path("sum.summary"), weighed = folder.Path("weighed.summary");
  Arguments frames = {"--lights", Lights()};
  for (int i = 1; i <= kNumFrames; i += 3) frames.push_back(Frame(i));
  RunSummarize(Joined(frames, {"-o", sum}));
  ASSERT_EQ(RunLightfit({"fit", "--summary", sum, "--json", first}).exit_code, 0);
  RunSummarize(Joined(frames, {"-o", weighed, "--weigh-by", first}));
  ASSERT_EQ(RunLightfit({"fit", "--summary", weighed, "--json", second}).exit_code, 0);
  const v1::FitResult before = ReadResult(first), after = ReadResult(second);
  ASSERT_EQ(after.lights_size(), 3);
  for (int l = 0; l < 3; ++l) {
    const double ratio = after.lights(l).energies().final() / before.lights(l).energies().final();
    std::cout << after.lights(l).name() << ": energy of round 2 over round 1 " << ratio
              << std::endl;
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 1.0);
  }
  ExpectError(RunLightfit({"summarize", sum, weighed, "-o", folder.Path("x.summary")}),
              2,
              {"weighed.summary", "--weigh-by"});
}

}  // namespace
}  // namespace lightfit
