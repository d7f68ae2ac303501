// `lightfit compare` from end to end: on a small scene and on a real read-back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "jobs/compare/json.h"
#include "tests/cli/examples.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/process.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

// A folder with scene.obj in it.
class CompareTest : public ::testing::Test {
 protected:
  CompareTest() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  // Compares on the scene, with a small screen.
  ProcessResult CompareScene(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"compare",
                                          folder_.Path("scene.obj"),
                                          "--camera",
                                          kBoxesCamera,
                                          "--screen",
                                          "160x120",
                                          "--map",
                                          "100x100"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  v1::Comparison ReadComparison(const std::string& name) const {
    v1::Comparison comparison;
    const absl::Status status = JsonToProto(ReadFile(folder_.Path(name)), comparison);
    EXPECT_TRUE(status.ok()) << status;
    return comparison;
  }

  const TemporaryFolder folder_;
};

void ExpectError(const ProcessResult& result, int exit_code, const std::string& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(words)));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST_F(CompareTest, OneLightGivesATableAllFilesAndAPicture) {
  const ProcessResult result = CompareScene({"--light",
                                             "sun=sun:-1,-1.3,0.4",
                                             "--csv",
                                             folder_.Path("out.csv"),
                                             "--json",
                                             folder_.Path("out.json"),
                                             "--picture",
                                             folder_.Path("out.png")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, AllOf(HasSubstr("160 x 120 pixels"), HasSubstr("plane-optimal")));
  // The read-back has the screen's aspect ratio.
  EXPECT_THAT(result.out, HasSubstr("read-back 208 x 156 pixels; map 100 x 100 texels"));
  EXPECT_THAT(folder_.Files(), ElementsAre("out.csv", "out.json", "out.png", "scene.obj"));
  EXPECT_THAT(ReadFile(folder_.Path("out.png")), StartsWith("\x89PNG"));

  const v1::Comparison comparison = ReadComparison("out.json");
  ASSERT_EQ(comparison.lights_size(), 1);
  const v1::LightComparison& light = comparison.lights(0);
  EXPECT_EQ(light.methods_size(), 10);
  EXPECT_EQ(light.lighting().background() + light.lighting().facing_away() +
                light.lighting().lit() + light.lighting().shadowed(),
            160 * 120);
  const v1::MethodComparison& ours = light.methods(light.methods_size() - 1);
  EXPECT_EQ(ours.method(), "lightfit");
  for (const v1::MethodComparison& method : light.methods()) {
    SCOPED_TRACE(method.method());
    EXPECT_EQ(method.status().code(), 0) << method.status().message();
    EXPECT_GT(method.wrong().ideal(), 0);
    EXPECT_DOUBLE_EQ(method.ideal_ratio(),
                     static_cast<double>(method.wrong().ideal()) / ours.wrong().ideal());
    EXPECT_DOUBLE_EQ(method.energy_ratio(), method.energy() / ours.energy());
    // The table shows the same counts.
    EXPECT_THAT(result.out, HasSubstr(absl::StrCat(method.wrong().ideal())));
  }
  const std::vector<std::string> lines = absl::StrSplit(ReadFile(folder_.Path("out.csv")), '\n');
  ASSERT_EQ(lines.size(), 12u);
  EXPECT_THAT(lines[10],
              HasSubstr(absl::StrCat(
                  ",lightfit,ok,", ours.wrong().ideal(), ",", ours.wrong().practical(), ",")));
}

TEST_F(CompareTest, TwoRunsGiveTheSameBytes) {
  for (const char* name : {"a", "b"}) {
    const ProcessResult result = CompareScene({"--light",
                                               "lamp=point:4,9,6",
                                               "--json",
                                               folder_.Path(absl::StrCat(name, ".json")),
                                               "--picture",
                                               folder_.Path(absl::StrCat(name, ".png"))});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_EQ(ReadFile(folder_.Path("a.json")), ReadFile(folder_.Path("b.json")));
  EXPECT_EQ(ReadFile(folder_.Path("a.png")), ReadFile(folder_.Path("b.png")));
}

TEST_F(CompareTest, RandomLightsGiveTotals) {
  const ProcessResult result = CompareScene(
      {"--random-lights", "5", "--seed", "3", "--per-light", "--json", folder_.Path("out.json")});
  EXPECT_THAT(result.exit_code, AnyOf(0, 3)) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("5 lights"), HasSubstr("sun005: ")));
  const v1::Comparison comparison = ReadComparison("out.json");
  EXPECT_EQ(comparison.lights_size(), 5);
  ASSERT_EQ(comparison.totals_size(), 10);
  for (int row = 0; row < 10; ++row) {
    const v1::MethodTotals& totals = comparison.totals(row);
    int64_t sum = 0;
    for (const v1::LightComparison& light : comparison.lights()) {
      if (light.methods(9).status().code() == 0) sum += light.methods(row).wrong().ideal();
    }
    EXPECT_EQ(totals.ideal().total(), sum) << totals.method();
    EXPECT_EQ(totals.num_lights() + totals.num_failed(), 5) << totals.method();
  }
}

// One light among what it lights does not stop the other.
TEST_F(CompareTest, LightsWithoutAMatrixAreNamed) {
  const ProcessResult result = CompareScene({"--light",
                                             "among=point:0,0.2,0",
                                             "--cover",
                                             "receivers",
                                             "--light",
                                             "sun=sun:-1,-1.3,0.4",
                                             "--picture",
                                             folder_.Path("out.png")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("no matrix for light \"among\""), Not(HasSubstr("sun\""))));
  EXPECT_THAT(result.out, HasSubstr("2 lights"));
  EXPECT_THAT(folder_.Files(), ElementsAre("out.png", "scene.obj"));
}

// A result of `lightfit fit` for a map of another size is the same map in other texels.
TEST_F(CompareTest, MatricesFromAFileAreFurtherRows) {
  const std::string json = folder_.Path("fit.json");
  const ProcessResult fit =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--map", "200x300", "--json", json});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProcessResult result = RunLightfit({"compare",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--map",
                                            "400x600",
                                            "--matrix",
                                            absl::StrCat("engine=", json),
                                            "--json",
                                            folder_.Path("out.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const v1::Comparison comparison = ReadComparison("out.json");
  ASSERT_EQ(comparison.lights_size(), 3);
  for (const v1::LightComparison& light : comparison.lights()) {
    SCOPED_TRACE(light.name());
    ASSERT_EQ(light.methods_size(), 11);
    EXPECT_EQ(light.methods(9).method(), "engine");
    EXPECT_NEAR(light.methods(9).energy_ratio(), 1, 1e-9);
  }
}

// Half of the map outside: what is there is dark, or lit.
TEST_F(CompareTest, AMatrixFromAFileBringsItsBorder) {
  const std::vector<std::string> sun = {"--light", "sun=sun:-1,-1.3,0.4"};
  const auto compare = [&](std::vector<std::string> more) {
    more.insert(more.end(), sun.begin(), sun.end());
    more.insert(more.end(), {"--json", folder_.Path("out.json"), "--csv", folder_.Path("out.csv")});
    return CompareScene(more);
  };
  ASSERT_EQ(compare({}).exit_code, 0);
  v1::Comparison comparison = ReadComparison("out.json");
  v1::Matrix4x4 matrix = comparison.lights(0).methods(9).map_from_world();
  for (int column = 0; column < 4; ++column) {
    matrix.set_m(column, matrix.m(column) + 50.0 * matrix.m(12 + column));
  }
  const std::string numbers = absl::StrJoin(matrix.m(), ", ");
  for (const char* border : {"lit", "dark"}) {
    WriteFile(folder_.Path(absl::StrCat(border, ".json")),
              absl::StrCat("{\"map_from_world\": [", numbers, "], \"border\": \"", border, "\"}"));
  }
  const ProcessResult result = compare({"--matrix",
                                        "bright=" + folder_.Path("lit.json"),
                                        "--matrix",
                                        "night=" + folder_.Path("dark.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("  border  "), HasSubstr("    dark  ")));
  comparison = ReadComparison("out.json");
  const auto& methods = comparison.lights(0).methods();
  EXPECT_EQ(methods[0].border(), v1::BORDER_LIT);
  EXPECT_EQ(methods[9].border(), v1::BORDER_LIT);
  EXPECT_EQ(methods[10].border(), v1::BORDER_DARK);
  EXPECT_GT(methods[9].wrong().outside(), 0);
  EXPECT_GT(methods[10].wrong().outside(), 2 * methods[9].wrong().outside());
  EXPECT_THAT(ReadFile(folder_.Path("out.csv")), HasSubstr(",dark,\n"));
}

TEST_F(CompareTest, CountsAreMeansOfThePhasesAskedFor) {
  const auto count = [this](const std::vector<std::string>& more, const char* heading) {
    std::vector<std::string> arguments = {
        "--light", "sun=sun:-1,-1.3,0.4", "--json", folder_.Path("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = CompareScene(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr(absl::StrCat("map 100 x 100 texels", heading, "\n")));
    return ReadComparison("out.json");
  };
  const v1::Comparison by_default = count({}, ", mean of 4 phases");
  EXPECT_EQ(by_default.phases(), 4);
  const v1::Comparison one = count({"--phases", "1"}, "");
  EXPECT_EQ(one.phases(), 1);
  const v1::Comparison nine = count({"--phases", "9"}, ", mean of 9 phases");
  EXPECT_EQ(nine.phases(), 9);
  // Some tens of pixels a row: counts of one phase are off by a third, the rows together by less.
  int num_different = 0;
  double total_by_default = 0.0, total_of_nine = 0.0;
  for (int row = 0; row < 10; ++row) {
    const auto wrong = [row](const v1::Comparison& comparison) {
      return static_cast<double>(comparison.lights(0).methods(row).wrong().ideal());
    };
    num_different += wrong(one) != wrong(nine);
    total_by_default += wrong(by_default);
    total_of_nine += wrong(nine);
  }
  EXPECT_NEAR(total_by_default, total_of_nine, 0.2 * total_of_nine);
  EXPECT_GT(num_different, 5);
}

TEST_F(CompareTest, AReadbackGivesEnergiesOnly) {
  const ProcessResult result = RunLightfit(
      {"compare", kYard, "--lights", kYardLights, "--per-light", "--csv", folder_.Path("out.csv")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("3 lights"), HasSubstr("no truth"), HasSubstr("rim: ")));
  EXPECT_THAT(result.out, Not(HasSubstr("practical")));
  EXPECT_THAT(result.out, Not(AnyOf(HasSubstr("nan"), HasSubstr("inf"))));
  EXPECT_THAT(ReadFile(folder_.Path("out.csv")), HasSubstr(",lightfit,ok,,,,,,,"));
}

TEST_F(CompareTest, QuietSaysNothing) {
  const ProcessResult result = CompareScene({"--light", "sun=sun:-1,-1.3,0.4", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out + result.err, IsEmpty());
}

TEST_F(CompareTest, HelpHasUnitsAndExamples) {
  const ProcessResult result = RunLightfit({"compare", "--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("--random-lights"),
                    HasSubstr("texels [1024x1024]"),
                    HasSubstr("750x750 where it says nothing]"),
                    HasSubstr("Examples"),
                    HasSubstr("--metric")));
}

TEST_F(CompareTest, WrongUsageIsExitCodeOne) {
  ExpectError(RunLightfit({"compare"}), 1, "");
  const auto with = [](const char* flag, const char* value) {
    return RunLightfit({"compare", "scene.obj", flag, value});
  };
  ExpectError(with("--screen", "750"), 1, "\"750\" is no size");
  ExpectError(with("--screen", "0x10"), 1, "0x10");
  ExpectError(with("--readback", "99999x99999"), 1, "99999x99999");
  ExpectError(with("--map", "60000x60000"), 1, "16384x16384");
  ExpectError(CompareScene({"--matrix", "engine"}), 1, "NAME=FILE");
  ExpectError(CompareScene({"--matrix", "focused=x.json"}), 1, "is a method already");
  ExpectError(CompareScene({"--matrix", "a=x.json", "--matrix", "a=y.json"}), 1, "taken");
  ExpectError(CompareScene({"--bias", "none"}), 1, "--bias");
  ExpectError(CompareScene({"--bias-share", "-1"}), 1, "--bias-share");
  ExpectError(CompareScene({"--phases", "3"}), 1, "--phases 3, want a square number");
  ExpectError(CompareScene({"--phases", "81"}), 1, "81");
  ExpectError(CompareScene({"--margin-percent", "nan"}), 1, "nan");
  ExpectError(
      CompareScene({"--bias-share", "nan"}), 1, "--bias-share: \"nan\", want a number from 0 to 1");
}

TEST_F(CompareTest, UnusableInputsAreNamed) {
  const std::vector<std::string> sun = {"--light", "sun=sun:-1,-1.3,0.4"};
  const auto with_sun = [&sun](std::vector<std::string> more) {
    more.insert(more.end(), sun.begin(), sun.end());
    return more;
  };
  ExpectError(CompareScene({}), 2, "no lights");
  ExpectError(RunLightfit(with_sun({"compare", folder_.Path("scene.obj")})), 2, "--camera");
  ExpectError(RunLightfit(with_sun({"compare", "/no/scene.glb", "--camera", kBoxesCamera})),
              2,
              "/no/scene.glb");
  ExpectError(RunLightfit(with_sun({"compare", "/no/frame.exr"})), 2, "/no/frame.exr");
  ExpectError(CompareScene(with_sun({"--matrix", "engine=/no/engine.json"})), 2, "/no/engine.json");
  ExpectError(CompareScene(with_sun({"--picture", "/no/out.png"})), 2, "/no");
  ExpectError(CompareScene(with_sun({"--picture-light", "sum"})), 2, "did you mean \"sun\"?");
  ExpectError(
      RunLightfit(with_sun({"compare", folder_.Path("scene.obj"), "--camera", "0,2,11:0,30,11.1"})),
      2,
      "sees no");
}

TEST_F(CompareTest, AReadbackRefusesWhatOnlyASceneHas) {
  const std::vector<std::string> yard = {"compare", kYard, "--lights", kYardLights};
  const auto with = [&yard](std::vector<std::string> more) {
    more.insert(more.begin(), yard.begin(), yard.end());
    return RunLightfit(more);
  };
  ExpectError(with({"--picture", folder_.Path("out.png")}), 2, "--picture");
  ExpectError(with({"--random-lights", "5"}), 2, "--random-lights");
  ExpectError(with({"--camera", kBoxesCamera}), 2, "--camera");
}

}  // namespace
}  // namespace lightfit
