// `lightfit allocate` end to end on rendered read-backs: what it prints, writes and returns.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "tests/cli/allocations.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Allocate, SplitsABudgetAndSaysWhatItBuys) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  const ProcessResult result = AllocateYard({"--budget", "2048x2048", "--json", json});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* words : {"budget of 4194304 texels",
                            "of budget",
                            "footprint, pixels",
                            "equal split",
                            "energy 0.",
                            "sun",
                            "key",
                            "rim"}) {
    EXPECT_THAT(result.out, HasSubstr(words));
  }
  const v1::Allocation allocation = ReadAllocation(json);
  EXPECT_EQ(allocation.budget_texels(), 2048 * 2048);
  EXPECT_LE(allocation.texels(), allocation.budget_texels());
  EXPECT_GT(allocation.texels(), 0.98 * static_cast<double>(allocation.budget_texels()));
  ASSERT_EQ(allocation.lights_size(), 3);
  ASSERT_EQ(allocation.maps_size(), 3);
  int64_t texels = 0;
  double energy = 0.0, equal = 0.0, share = 0.0;
  for (int i = 0; i < 3; ++i) {
    const v1::LightResult& light = allocation.lights(i);
    const v1::AllocatedMap& map = allocation.maps(i);
    EXPECT_EQ(light.name(), map.name());
    EXPECT_EQ(light.status().code(), 0);
    EXPECT_EQ(light.map().width() % 64, 0);
    EXPECT_EQ(light.map().height() % 64, 0);
    EXPECT_EQ(map.texels(), int64_t{light.map().width()} * light.map().height());
    EXPECT_TRUE(MatrixOf(light.map_from_world()).allFinite());
    EXPECT_GT(light.foretold_wrong().final(), 0.0);
    texels += map.texels();
    share += map.share();
    energy += light.energies().final();
    equal += map.equal_split_energy();
  }
  EXPECT_EQ(texels, allocation.texels());
  EXPECT_NEAR(share, static_cast<double>(texels) / allocation.budget_texels(), 1e-12);
  EXPECT_LT(energy, equal);
  EXPECT_EQ(allocation.options().metric(), v1::METRIC_L1_ACROSS_EDGE);
}

TEST(Allocate, MatricesAreThoseOfAFitOfThatSizeAndReadAsOne) {
  const TemporaryFolder folder;
  const std::string maps = folder.Path("maps.json"), fit = folder.Path("fit.json");
  ASSERT_EQ(AllocateYard({"--budget", "1500000", "--quiet", "--json", maps}).exit_code, 0);
  const v1::FitResult result = ReadResult(maps);
  ASSERT_EQ(result.lights_size(), 3);
  for (const v1::LightResult& light : result.lights()) {
    const std::string size = absl::StrCat(light.map().width(), "x", light.map().height());
    ASSERT_EQ(RunLightfit({"fit",
                           kYard,
                           "--lights",
                           kYardLights,
                           "--only",
                           light.name(),
                           "--map",
                           size,
                           "--quiet",
                           "--json",
                           fit})
                  .exit_code,
              0);
    EXPECT_EQ(MatrixOf(ReadResult(fit).lights(0).map_from_world()),
              MatrixOf(light.map_from_world()));
  }
}

TEST(Allocate, SameInputGivesTheSameBytes) {
  std::string json[2];
  for (std::string& bytes : json) {
    const TemporaryFolder folder;
    const std::string path = folder.Path("maps.json");
    ASSERT_EQ(AllocateYard({"--budget", "1024x1024", "--json", path, "--quiet"}).exit_code, 0);
    bytes = ReadFile(path);
    EXPECT_THAT(folder.Files(), ElementsAre("maps.json"));
  }
  EXPECT_FALSE(json[0].empty());
  EXPECT_EQ(json[0], json[1]);
}

TEST(Allocate, KeepsSizesToTheRules) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  ASSERT_EQ(AllocateYard({"--budget",
                          "2048x2048",
                          "--power-of-two",
                          "--min-side",
                          "128",
                          "--json",
                          json,
                          "--quiet"})
                .exit_code,
            0);
  const v1::Allocation allocation = ReadAllocation(json);
  EXPECT_TRUE(allocation.rules().powers_of_two());
  ASSERT_EQ(allocation.lights_size(), 3);
  for (const v1::LightResult& light : allocation.lights()) {
    for (const int side : {light.map().width(), light.map().height()}) {
      EXPECT_EQ(side & (side - 1), 0) << side;
      EXPECT_GE(side, 128);
    }
  }
}

TEST(Allocate, GivesMoreToALightOfMoreWeight) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  int64_t texels[2];
  for (const int weighted : {0, 1}) {
    ASSERT_EQ(AllocateYard({"--budget",
                            "2048x2048",
                            "--weight",
                            weighted ? "sun=5" : "sun=1",
                            "--json",
                            json,
                            "--quiet"})
                  .exit_code,
              0);
    const v1::Allocation allocation = ReadAllocation(json);
    ASSERT_EQ(allocation.maps_size(), 3);
    EXPECT_EQ(allocation.maps(0).name(), "sun");
    EXPECT_EQ(allocation.maps(0).weight(), weighted ? 5.0 : 1.0);
    texels[weighted] = allocation.maps(0).texels();
  }
  EXPECT_GT(static_cast<double>(texels[1]), 1.3 * static_cast<double>(texels[0]));
}

TEST(Allocate, MeetsATolerance) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  for (const char* tolerance : {"rms:1.0", "p99:1.5", "worst:40"}) {
    SCOPED_TRACE(tolerance);
    const ProcessResult result =
        AllocateYard({"--tolerance", tolerance, "--image", "720x720", "--json", json});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("kept"), HasSubstr("Guaranteed, where kept, for the")));
    const v1::Allocation allocation = ReadAllocation(json);
    EXPECT_EQ(allocation.tolerance().image_scale(), 4.0);
    EXPECT_EQ(allocation.options().metric(), v1::METRIC_L2);
    ASSERT_EQ(allocation.maps_size(), 3);
    for (int i = 0; i < 3; ++i) {
      const v1::ToleranceReached& reached = allocation.maps(i).reached();
      EXPECT_TRUE(reached.is_met());
      EXPECT_LE(reached.reached_px(), allocation.tolerance().limit_px());
      EXPECT_LE(reached.num_samples(), allocation.lights(i).samples().used());
      EXPECT_GT(reached.num_samples(), 0.9 * allocation.lights(i).samples().used());
      const v1::FootprintStatistics& footprint = allocation.lights(i).footprint();
      if (allocation.tolerance().kind() == v1::Tolerance::KIND_RMS) {
        EXPECT_NEAR(4.0 * footprint.rms(), reached.reached_px(), 1e-9);
      }
      if (allocation.tolerance().kind() == v1::Tolerance::KIND_WORST) {
        EXPECT_NEAR(4.0 * footprint.worst(), reached.reached_px(), 1e-9);
      }
    }
  }
}

TEST(Allocate, NamesTheLightsThatMissTheToleranceAndGivesTheirBest) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("maps.json");
  const ProcessResult result =
      AllocateYard({"--tolerance", "rms:0.01", "--max-side", "512", "--json", json});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("light \"sun\": "),
                    HasSubstr("pixels at the largest map, 512 x 512"),
                    HasSubstr("raise --max-side (512), or --tolerance rms:")));
  EXPECT_THAT(result.out, HasSubstr("missed"));
  const v1::Allocation allocation = ReadAllocation(json);
  EXPECT_FALSE(allocation.maps(0).reached().is_met());
  EXPECT_TRUE(MatrixOf(allocation.lights(0).map_from_world()).allFinite());
}

// What the message says can be kept is kept, by each light at the same largest map; and no less
// can.
TEST(Allocate, SaysWhichToleranceCanBeKept) {
  for (const char* kind : {"rms", "p99", "worst"}) {
    const std::vector<std::string> limits = {"--max-side", "512", "--quiet"};
    std::vector<std::string> arguments = {"--tolerance", absl::StrCat(kind, ":0.01")};
    arguments.insert(arguments.end(), limits.begin(), limits.end());
    const ProcessResult missed = AllocateYard(arguments);
    EXPECT_EQ(missed.exit_code, 3);
    int num_lights = 0;
    for (const absl::string_view line : absl::StrSplit(missed.err, '\n', absl::SkipEmpty())) {
      const std::vector<std::string> quoted = absl::StrSplit(line, '"');
      const std::vector<std::string> words = absl::StrSplit(line, "--tolerance ");
      ASSERT_EQ(quoted.size(), 3U) << line;
      ASSERT_EQ(words.size(), 2U) << line;
      const std::string tolerance = words[1].substr(0, words[1].find(' '));
      arguments = {"--only", quoted[1], "--tolerance", tolerance};
      arguments.insert(arguments.end(), limits.begin(), limits.end());
      const ProcessResult kept = AllocateYard(arguments);
      EXPECT_EQ(kept.exit_code, 0) << line << "\n" << kept.err;
      ++num_lights;
    }
    EXPECT_EQ(num_lights, 3);
  }
}

TEST(Allocate, LightsWithoutAMapDoNotStopTheOthers) {
  for (const std::vector<std::string>& goal :
       {std::vector<std::string>{"--budget", "1024x1024"}, {"--tolerance", "rms:0.5"}}) {
    std::vector<std::string> arguments = {"--light", "moon=sun:0,0,-1"};
    arguments.insert(arguments.end(), goal.begin(), goal.end());
    const ProcessResult result = AllocateYard(arguments);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("no map for light \"moon\""), HasSubstr("shadow.moon")));
    EXPECT_THAT(result.out, AllOf(HasSubstr("moon     no map"), HasSubstr("rim ")));
  }
}

TEST(Allocate, WrongUsageSaysTheWayOut) {
  ExpectError(AllocateYard({}), 1, "--budget WIDTHxHEIGHT or --tolerance rms:PIXELS");
  ExpectError(AllocateYard({"--budget", "1024x1024", "--tolerance", "rms:1"}), 1, "--tolerance");
  ExpectError(AllocateYard({"--budget", "0"}), 1, "want at least 1 texel");
  ExpectError(AllocateYard({"--budget", "big"}), 1, "or a number of texels");
  for (const char* tolerance : {"rms", "rms:", "p95:1", "rms:1:2", "rms:one"}) {
    ExpectError(AllocateYard({"--tolerance", tolerance}), 1, "want rms:PIXELS");
  }
  for (const char* tolerance : {"rms:0", "rms:-1", "rms:nan", "rms:inf"}) {
    ExpectError(AllocateYard({"--tolerance", tolerance}), 1, "want a number of pixels above 0");
  }
  ExpectError(AllocateYard({"--tolerance", "rms:1", "--metric", "l1"}), 1, "--metric");
  ExpectError(AllocateYard({"--tolerance", "rms:1", "--weight", "sun=2"}), 1, "--weight");
  ExpectError(AllocateYard({"--budget", "1024x1024", "--weight", "sun"}), 1, "LIGHT=NUMBER");
  ExpectError(AllocateYard({"--budget", "1024x1024", "--weight", "sun=0"}), 1, "above 0");
  ExpectError(AllocateYard({"--budget", "1024x1024", "--min-side", "70", "--max-side", "100"}),
              1,
              "no multiple of 64 lies in");
  ExpectError(AllocateYard({"--budget", "1024x1024", "--map", "64x64"}), 1, "--map");
}

TEST(Allocate, InputsThatDoNotFitSayTheWayOut) {
  ExpectError(AllocateYard({"--budget", "100x100"}), 2, "want at least 12288: 3 maps of 64x64");
  ExpectError(
      AllocateYard({"--budget", "1024x1024", "--weight", "son=2"}), 2, "did you mean \"sun\"?");
  ExpectError(
      AllocateYard({"--budget", "1024x1024", "--json", "/no/such/folder/x.json"}), 2, "--json");
}

TEST(Allocate, HelpSaysWhatABudgetIs) {
  const ProcessResult help = RunLightfit({"allocate", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(
      help.out,
      AllOf(HasSubstr("texture of its own"), HasSubstr("--tolerance"), HasSubstr("Examples")));
}

}  // namespace
}  // namespace lightfit
