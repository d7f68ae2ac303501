// `lightfit compare --matrix` with plans that `lightfit fit --maps` wrote.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "jobs/compare/json.h"
#include "lightfit/v1/comparison.pb.h"
#include "lightfit/v1/result.pb.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/testing/process.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const Arguments kSceneLights = {"--light", "sun=sun:-1,-1.3,0.4", "--light", "lamp=point:2,4,3"};

// A folder with scene.obj in it.
class GivenPlansTest : public ::testing::Test {
 protected:
  GivenPlansTest() { WriteFile(folder_.Path("scene.obj"), ToObj(BoxesOnFloor())); }

  // Plans of the scene's frame, in plan.json.
  v1::FitResult FitFrame(const std::string& texels) const {
    const std::string frame = folder_.Path("frame.exr"), json = folder_.Path("plan.json");
    const ProcessResult render = RunLightfit(Joined({"render",
                                                     folder_.Path("scene.obj"),
                                                     "--camera",
                                                     kBoxesCamera,
                                                     "--size",
                                                     "100x75",
                                                     "-o",
                                                     frame},
                                                    kSceneLights));
    EXPECT_EQ(render.exit_code, 0) << render.err;
    const ProcessResult fit = RunLightfit(Joined({"fit",
                                                  frame,
                                                  "--maps",
                                                  "3",
                                                  "--texels",
                                                  texels,
                                                  "--border",
                                                  "auto",
                                                  "--guard",
                                                  "1",
                                                  "--json",
                                                  json},
                                                 kSceneLights));
    EXPECT_EQ(fit.exit_code, 0) << fit.err;
    return Read<v1::FitResult>("plan.json");
  }

  // Of the scene with plan.json as the row "kept".
  ProcessResult CompareKept(const Arguments& more) const {
    return RunLightfit(Joined(Joined({"compare",
                                      folder_.Path("scene.obj"),
                                      "--camera",
                                      kBoxesCamera,
                                      "--screen",
                                      "120x90",
                                      "--readback",
                                      "100x75",
                                      "--phases",
                                      "1",
                                      "--matrix",
                                      "kept=" + folder_.Path("plan.json"),
                                      "--json",
                                      folder_.Path("out.json")},
                                     kSceneLights),
                              more));
  }

  template <typename Message>
  Message Read(const std::string& name) const {
    Message message;
    const absl::Status status = JsonToProto(ReadFile(folder_.Path(name)), message);
    EXPECT_TRUE(status.ok()) << status;
    return message;
  }

  const TemporaryFolder folder_;
};

const v1::MethodComparison& Row(const v1::LightComparison& light, const std::string& name) {
  for (const v1::MethodComparison& method : light.methods()) {
    if (method.method() == name) return method;
  }
  ADD_FAILURE() << "no row " << name;
  return v1::MethodComparison::default_instance();
}

// The maps of a row are those of the file, to the last digit.
void ExpectPlanOfFile(const v1::MethodComparison& row, const v1::LightResult& light) {
  ASSERT_EQ(row.status().code(), 0) << row.status().message();
  EXPECT_EQ(row.border(), light.plan().border());
  EXPECT_EQ(row.maps().guard_texels(), light.plan().guard_texels());
  EXPECT_EQ(row.maps().texels(), light.plan().texels());
  ASSERT_EQ(row.maps().plan_size(), light.plan().maps_size());
  for (int k = 0; k < row.maps().plan_size(); ++k) {
    const v1::MethodMap& map = row.maps().plan(k);
    EXPECT_EQ(map.map().SerializeAsString(), light.plan().maps(k).map().SerializeAsString());
    EXPECT_EQ(map.map_from_world().SerializeAsString(),
              light.plan().maps(k).map_from_world().SerializeAsString());
  }
}

// The plans of a comparison's row "lightfit" as a fit would write them.
v1::FitResult PlansOf(const v1::Comparison& comparison) {
  v1::FitResult result;
  for (const v1::LightComparison& light : comparison.lights()) {
    const v1::MethodComparison& row = Row(light, "lightfit");
    v1::LightResult& added = *result.add_lights();
    added.set_name(light.name());
    v1::Plan& plan = *added.mutable_plan();
    plan.set_border(row.border());
    plan.set_guard_texels(row.maps().guard_texels());
    plan.set_texels(row.maps().texels());
    for (const v1::MethodMap& map : row.maps().plan()) {
      v1::PlanMap& of_plan = *plan.add_maps();
      of_plan.set_index(plan.maps_size() - 1);
      *of_plan.mutable_map() = map.map();
      *of_plan.mutable_map_from_world() = map.map_from_world();
    }
  }
  return result;
}

// A file's camera has other roundings than the comparison's own frame, so that a fit from it is not
// the same plan to the last digit: the comparison's own plan is.
TEST_F(GivenPlansTest, TheSamePlanHasTheSameWrongPixels) {
  const Arguments maps = {
      "--maps", "3", "--texels", "40x40", "--guard", "1", "--per-light", "--legend"};
  const v1::FitResult fit = FitFrame("40x40");
  EXPECT_GT(fit.lights(1).plan().maps_size(), 1);
  const ProcessResult of_fit = CompareKept(maps);
  ASSERT_EQ(of_fit.exit_code, 0) << of_fit.err;
  EXPECT_THAT(of_fit.out,
              AllOf(HasSubstr("\nkept "), HasSubstr("\nplans from files (--matrix) keep")));
  const v1::Comparison before = Read<v1::Comparison>("out.json");
  ASSERT_EQ(before.lights_size(), 2);
  for (int l = 0; l < 2; ++l) ExpectPlanOfFile(Row(before.lights(l), "kept"), fit.lights(l));

  WriteFile(folder_.Path("plan.json"), *ProtoToJson(PlansOf(before)));
  const ProcessResult of_ours = CompareKept(maps);
  ASSERT_EQ(of_ours.exit_code, 0) << of_ours.err;
  const v1::Comparison comparison = Read<v1::Comparison>("out.json");
  for (const v1::LightComparison& light : comparison.lights()) {
    SCOPED_TRACE(light.name());
    const v1::MethodComparison& kept = Row(light, "kept");
    const v1::MethodComparison& ours = Row(light, "lightfit");
    EXPECT_EQ(kept.maps().SerializeAsString(), ours.maps().SerializeAsString());
    EXPECT_GT(kept.wrong().ideal(), 0);
    EXPECT_EQ(kept.wrong().SerializeAsString(), ours.wrong().SerializeAsString());
    EXPECT_EQ(kept.foretold_share(), ours.foretold_share());
    EXPECT_EQ(kept.energy(), ours.energy());
  }
  EXPECT_GT(Row(comparison.lights(1), "kept").maps().plan_size(), 1);
}

TEST_F(GivenPlansTest, PlansStandBesideSingleMapsAndSayTheirTexels) {
  const v1::FitResult fit = FitFrame("100x100");
  const ProcessResult result = CompareKept({"--map",
                                            "64x64",
                                            "--per-light",
                                            "--csv",
                                            folder_.Path("out.csv"),
                                            "--picture",
                                            folder_.Path("out.png"),
                                            "--picture-light",
                                            "lamp"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(ReadFile(folder_.Path("out.png")), StartsWith("\x89PNG"));
  const v1::Comparison comparison = Read<v1::Comparison>("out.json");
  for (int l = 0; l < 2; ++l) {
    const v1::LightComparison& light = comparison.lights(l);
    SCOPED_TRACE(light.name());
    const v1::MethodComparison& kept = Row(light, "kept");
    ExpectPlanOfFile(kept, fit.lights(l));
    EXPECT_TRUE(kept.has_wrong());
    const std::string texels =
        absl::StrCat(kept.maps().texels(), " texels in all, and not the 4096 of one map here");
    EXPECT_THAT(kept.note(), HasSubstr(texels));
    EXPECT_THAT(result.out, HasSubstr(texels));
    EXPECT_THAT(ReadFile(folder_.Path("out.csv")), HasSubstr(texels));
  }
  EXPECT_EQ(Row(comparison.lights(0), "lightfit").maps().texels(), 4096);
}

// Of a real read-back: no truth, but the energies and forecasts of the same plans.
TEST_F(GivenPlansTest, AReadbackGivesThePlansFigures) {
  const ProcessResult fit = RunLightfit({"fit",
                                         kYard,
                                         "--lights",
                                         kYardLights,
                                         "--maps",
                                         "3",
                                         "--texels",
                                         "160000",
                                         "--border",
                                         "auto",
                                         "--json",
                                         folder_.Path("plan.json")});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const v1::FitResult fitted = Read<v1::FitResult>("plan.json");
  const ProcessResult result = RunLightfit({"compare",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--maps",
                                            "3",
                                            "--texels",
                                            "160000",
                                            "--matrix",
                                            "kept=" + folder_.Path("plan.json"),
                                            "--json",
                                            folder_.Path("out.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const v1::Comparison plans = Read<v1::Comparison>("out.json");
  ASSERT_EQ(plans.lights_size(), 3);
  for (int l = 0; l < 3; ++l) {
    SCOPED_TRACE(plans.lights(l).name());
    const v1::MethodComparison& kept = Row(plans.lights(l), "kept");
    const v1::MethodComparison& ours = Row(plans.lights(l), "lightfit");
    ExpectPlanOfFile(kept, fitted.lights(l));
    EXPECT_EQ(kept.maps().SerializeAsString(), ours.maps().SerializeAsString());
    EXPECT_EQ(kept.energy(), ours.energy());
    EXPECT_EQ(kept.foretold_share(), ours.foretold_share());
    EXPECT_LT(kept.energy(), Row(plans.lights(l), "one map").energy());
  }
}

TEST_F(GivenPlansTest, UnusablePlansAreNamed) {
  v1::FitResult fit = FitFrame("100x100");
  const auto compare = [&](const v1::FitResult& result) {
    WriteFile(folder_.Path("plan.json"), *ProtoToJson(result));
    return CompareKept({"--map", "32x32", "--per-light"});
  };
  v1::FitResult empty = fit;
  empty.mutable_lights(1)->mutable_plan()->clear_maps();
  const ProcessResult refused = compare(empty);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.out, IsEmpty());
  EXPECT_THAT(refused.err,
              AllOf(StartsWith("lightfit: error: "),
                    HasSubstr("plan.json: light \"lamp\": plan.maps: 0 of them, want 1 ... 32")));

  // The matrix is looked at with the light of the comparison: the row fails, others do not.
  v1::FitResult singular = fit;
  v1::Matrix4x4& matrix =
      *singular.mutable_lights(1)->mutable_plan()->mutable_maps(1)->mutable_map_from_world();
  for (int column = 0; column < 4; ++column) matrix.set_m(4 + column, matrix.m(column));
  const ProcessResult result = compare(singular);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(
      result.out,
      AllOf(HasSubstr("\nkept: "),
            HasSubstr("plan.json: plan.maps[1]: light \"lamp\": map_from_world is singular")));
  const v1::Comparison comparison = Read<v1::Comparison>("out.json");
  EXPECT_EQ(Row(comparison.lights(0), "kept").status().code(), 0);
  EXPECT_NE(Row(comparison.lights(1), "kept").status().code(), 0);
}

TEST(GivenPlans, HelpSaysThatPlansKeepTheirSizes) {
  EXPECT_THAT(RunLightfit({"compare", "--help"}).out,
              AllOf(HasSubstr("Matrices or plans from elsewhere"),
                    HasSubstr("Plans keep the\nsizes, border and guard of their file"),
                    Not(HasSubstr("plans cannot"))));
}

}  // namespace
}  // namespace lightfit
