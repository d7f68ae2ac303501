// `lightfit compare --maps` from end to end: on a small scene and on a real read-back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "jobs/compare/json.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/process.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kNumRows = 26;

// A folder with scene.obj in it.
class ComparePlansTest : public ::testing::Test {
 protected:
  ComparePlansTest() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  ProcessResult CompareScene(const Arguments& more) const {
    return RunLightfit(Joined({"compare",
                               folder_.Path("scene.obj"),
                               "--camera",
                               kBoxesCamera,
                               "--screen",
                               "120x90",
                               "--readback",
                               "100x75"},
                              more));
  }

  v1::Comparison ReadComparison(const std::string& name) const {
    v1::Comparison comparison;
    const absl::Status status = JsonToProto(ReadFile(folder_.Path(name)), comparison);
    EXPECT_TRUE(status.ok()) << status;
    return comparison;
  }

  const TemporaryFolder folder_;
};

TEST_F(ComparePlansTest, EverySchemeHasARowOfEqualTexels) {
  const ProcessResult result = RunLightfit({"compare",     "generate:triangles=20000",
                                            "--camera",    "0,1.7,18:0,0.5,0",
                                            "--screen",    "160x120",
                                            "--readback",  "100x75",
                                            "--light",     "sun=sun:-1,-1.3,0.4",
                                            "--light",     "lamp=point:2,4,3",
                                            "--per-light", "--legend",
                                            "--maps",      "4",
                                            "--texels",    "100x100",
                                            "--phases",    "1",
                                            "--json",      folder_.Path("out.json"),
                                            "--csv",       folder_.Path("out.csv"),
                                            "--picture",   folder_.Path("out.png")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("up to 4 maps for each light, 10000 texels in all"),
                    HasSubstr("lightfit: maps that are parallelograms"),
                    HasSubstr("\ncube, cube, turned: light \"sun\": a cube map is for point"),
                    HasSubstr("2 lights"),
                    HasSubstr("Maps, texels: ")));
  EXPECT_THAT(result.out, Not(AnyOf(HasSubstr("nan"), HasSubstr("inf "))));
  EXPECT_THAT(ReadFile(folder_.Path("out.png")), StartsWith("\x89PNG"));

  const v1::Comparison comparison = ReadComparison("out.json");
  EXPECT_EQ(comparison.plan_options().max_maps(), 4);
  EXPECT_EQ(comparison.map().width(), 100);
  ASSERT_EQ(comparison.lights_size(), 2);
  ASSERT_EQ(comparison.totals_size(), kNumRows);
  for (const v1::LightComparison& light : comparison.lights()) {
    SCOPED_TRACE(light.name());
    ASSERT_EQ(light.methods_size(), kNumRows);
    std::map<std::string, const v1::MethodComparison*> methods;
    for (const v1::MethodComparison& method : light.methods()) methods[method.method()] = &method;
    const v1::MethodComparison& ours = *methods["lightfit"];
    EXPECT_EQ(ours.status().code(), 0);
    for (const auto& [name, method] : methods) {
      SCOPED_TRACE(name);
      if (method->status().code() != 0) {
        EXPECT_THAT(result.out, HasSubstr(method->status().message()));
        continue;
      }
      EXPECT_LE(method->maps().texels(), 10000);
      EXPECT_GE(method->wrong().ideal(), ours.wrong().ideal());
      EXPECT_DOUBLE_EQ(method->ideal_ratio(),
                       static_cast<double>(method->wrong().ideal()) / ours.wrong().ideal());
      EXPECT_EQ(method->has_foretold_share(), method->maps().plan_size() > 0);
    }
    const bool is_sun = light.name() == "sun";
    EXPECT_EQ(methods["pages"]->status().code() == 0, is_sun);
    EXPECT_EQ(methods["stable4"]->status().code() == 0, is_sun);
    EXPECT_EQ(methods["cube"]->status().code() == 0, !is_sun);
    EXPECT_EQ(methods["paraboloids, drawn"]->status().code() == 0, !is_sun);
    // The lamp hangs among its receivers.
    EXPECT_EQ(methods["as-published"]->status().code() == 0, is_sun);
    EXPECT_EQ(ours.maps().plan_size() > 1, !is_sun);
    EXPECT_EQ(ours.has_map_from_world(), is_sun);
  }
  const std::vector<std::string> lines = absl::StrSplit(ReadFile(folder_.Path("out.csv")), '\n');
  EXPECT_EQ(lines.size(), 2u * kNumRows + 2);
  EXPECT_THAT(lines[0], HasSubstr(",maps,texels,border,note"));
}

TEST_F(ComparePlansTest, MapsOfOneSizeWithAGuardAndTheirCrawl) {
  const ProcessResult result = CompareScene({"--light",
                                             "sun=sun:-1,-1.3,0.4",
                                             "--maps",
                                             "3",
                                             "--map",
                                             "64x48",
                                             "--guard",
                                             "1.5",
                                             "--crawl",
                                             "--phases",
                                             "1",
                                             "--json",
                                             folder_.Path("out.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("up to 3 maps for each light, 64 x 48 texels each"),
                    HasSubstr("PSSM3 "),
                    HasSubstr("% flips")));
  const v1::Comparison comparison = ReadComparison("out.json");
  EXPECT_EQ(comparison.plan_options().guard_texels(), 1.5);
  for (const v1::MethodComparison& method : comparison.lights(0).methods()) {
    SCOPED_TRACE(method.method());
    if (method.status().code() != 0) continue;
    EXPECT_LE(method.maps().texels(), 3 * 64 * 48);
    EXPECT_TRUE(method.crawl().has_flicker()) << method.note();
    if (method.maps().plan_size() == 0) continue;
    EXPECT_EQ(method.maps().guard_texels(), 1.5);
  }
  const v1::MethodComparison& ours = comparison.lights(0).methods(kNumRows - 1);
  for (const v1::MethodMap& map : ours.maps().plan()) EXPECT_EQ(map.map().width(), 64);
  EXPECT_GT(ours.crawl().num_points(), 100);
}

TEST_F(ComparePlansTest, AReadbackGivesEnergiesOfPlans) {
  const ProcessResult result = RunLightfit({"compare",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--maps",
                                            "2",
                                            "--texels",
                                            "160000",
                                            "--json",
                                            folder_.Path("out.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("160000 texels in all"), HasSubstr("no truth"), HasSubstr("SDSM2")));
  const v1::Comparison comparison = ReadComparison("out.json");
  for (const v1::LightComparison& light : comparison.lights()) {
    SCOPED_TRACE(light.name());
    std::map<std::string, const v1::MethodComparison*> methods;
    for (const v1::MethodComparison& method : light.methods()) {
      methods[method.method()] = &method;
      EXPECT_FALSE(method.has_wrong());
    }
    EXPECT_EQ(methods["lightfit"]->maps().plan_size(), 2);
    EXPECT_LT(methods["lightfit"]->energy(), methods["one map"]->energy());
    EXPECT_GT(methods["ZP2"]->energy_ratio(), 1.0);
  }
}

TEST_F(ComparePlansTest, OptionsThatDoNotGoTogetherAreRefused) {
  const auto expect_usage = [this](const Arguments& more, const char* words) {
    const ProcessResult result = CompareScene(Joined({"--light", "sun=sun:-1,-1.3,0.4"}, more));
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(words)));
    EXPECT_THAT(result.out, IsEmpty());
  };
  expect_usage({"--maps", "0"}, "--maps");
  expect_usage({"--maps", "33"}, "--maps");
  expect_usage({"--texels", "100x100"}, "--maps 2 or more");
  expect_usage({"--guard", "2"}, "--maps 2 or more");
  expect_usage({"--maps", "4", "--texels", "9999", "--map", "50x50"}, "give one of the two");
  expect_usage({"--maps", "4", "--map", "8x8", "--guard", "4"},
               "--map 8x8: the --guard of 4 texels on every side leaves nothing");
  expect_usage({"--maps", "4", "--min-side", "64", "--guard", "40"},
               "--min-side 64: the --guard of 40 texels");
  expect_usage({"--maps", "4", "--min-side", "65", "--max-side", "70"},
               "no multiple of 64 lies in --min-side ... --max-side 65 ... 70 texels");
  expect_usage({"--maps", "4", "--search", "line"}, "does not go with --search");
  expect_usage({"--maps", "4", "--texels", "10"}, "--texels 10, want 256");
  expect_usage({"--maps", "4", "--matrix", "ZP4=x.json"}, "is a method already");
}

TEST_F(ComparePlansTest, HelpTellsOfSeveralMaps) {
  const ProcessResult result = RunLightfit({"compare", "--help"});
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("--maps COUNT"),
                    HasSubstr("[1024x1024, as one map has]"),
                    HasSubstr("--maps 4 --texels 1024x1024")));
}

}  // namespace
}  // namespace lightfit
