// `lightfit fit --maps`: several maps for one light, end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "geometry/clip.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/partition/receivers.h"
#include "tests/testing/process.h"
#include "wire/plan_proto.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Products of matrices, rounded.
constexpr double kMatrixTolerance = 1e-12;

const Arguments kFitYard = {"fit", kYard, "--lights", kYardLights};
const Arguments kFitRoom = {"fit", kRoom, "--lights", kRoomLights, "--cover", "receivers"};

v1::FitResult FitJson(const Arguments& arguments) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  const ProcessResult result = RunLightfit(Joined(arguments, {"--json", json, "--quiet"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  return ReadResult(json);
}

Plan PlanIn(const v1::LightResult& light) {
  const absl::StatusOr<Plan> plan = PlanFromProto(light.plan(), "plan");
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *plan : Plan();
}

TEST(FitPlan, WritesSeveralMapsThatNeverHaveMoreTexelsThanAskedFor) {
  for (const auto& [maps, texels, budget] :
       {std::tuple("4", "300x400", 120000), {"2", "90000", 90000}, {"8", "", 1 << 20}}) {
    SCOPED_TRACE(maps);
    Arguments arguments = Joined(kFitYard, {"--maps", maps});
    if (*texels != '\0') arguments = Joined(arguments, {"--texels", texels});
    const v1::FitResult result = FitJson(arguments);
    EXPECT_EQ(result.plan_options().max_maps(), std::stoi(maps));
    EXPECT_EQ(result.plan_options().texels(), budget);
    ASSERT_EQ(result.lights_size(), 3);
    for (const v1::LightResult& light : result.lights()) {
      SCOPED_TRACE(light.name());
      EXPECT_EQ(light.status().code(), 0);
      // This read-back does not tell which surfaces face a light, so as many as may be.
      EXPECT_EQ(light.plan().maps_size(), std::stoi(maps));
      EXPECT_FALSE(light.has_map_from_world());
      const int64_t num_texels = NumTexels(PlanIn(light));
      EXPECT_EQ(light.plan().texels(), num_texels);
      EXPECT_LE(num_texels, budget);
      EXPECT_GT(num_texels, 0.95 * budget);
      EXPECT_EQ(light.plan().border(), light.border());
      EXPECT_LT(light.energies().final(), light.energies().one_map());
      EXPECT_LT(light.energies().one_map(), light.energies().as_published());
      double energy = 0.0;
      for (const v1::PlanMap& map : light.plan().maps()) energy += map.energy();
      EXPECT_NEAR(energy, light.energies().final(), 1e-9 * energy);
    }
  }
}

TEST(FitPlan, GivesEveryMapTheSizeOfMap) {
  const v1::FitResult result =
      FitJson(Joined(kFitYard, {"--maps", "3", "--map", "256x128", "--guard", "1.5"}));
  EXPECT_EQ(result.plan_options().each().width(), 256);
  EXPECT_EQ(result.plan_options().texels(), 0);
  EXPECT_EQ(result.plan_options().guard_texels(), 1.5);
  for (const v1::LightResult& light : result.lights()) {
    EXPECT_EQ(light.plan().guard_texels(), 1.5);
    ASSERT_EQ(light.plan().maps_size(), 3);
    for (const v1::PlanMap& map : light.plan().maps()) {
      EXPECT_EQ(map.map().width(), 256);
      EXPECT_EQ(map.map().height(), 128);
    }
  }
}

// What a renderer does with the file: every shadowed pixel finds a map, guard or not.
TEST(FitPlan, EveryShadowedPixelAsksAMap) {
  const absl::StatusOr<std::vector<Light>> lights = ReadLightsFile(kYardLights);
  ASSERT_TRUE(lights.ok()) << lights.status();
  const absl::StatusOr<ReadbackFile> file = ReadReadbackExr(kYard, *lights);
  ASSERT_TRUE(file.ok()) << file.status();
  const Readback readback = file->View();
  const absl::StatusOr<Surfaces> surfaces = FindSurfaces(readback, LightMask(*lights), {});
  ASSERT_TRUE(surfaces.ok()) << surfaces.status();
  for (const char* guard : {"0", "2"}) {
    const v1::FitResult result =
        FitJson(Joined(kFitYard, {"--maps", "4", "--border", "lit", "--guard", guard}));
    ASSERT_EQ(result.lights_size(), static_cast<int>(lights->size()));
    for (size_t l = 0; l < lights->size(); ++l) {
      const Light& light = (*lights)[l];
      SCOPED_TRACE(light.name);
      const v1::LightResult& fitted = result.lights(static_cast<int>(l));
      EXPECT_EQ(fitted.border(), v1::BORDER_LIT);
      const Plan plan = PlanIn(fitted);
      const absl::StatusOr<PlanLookUp> look_up =
          PlanLookUp::Create(plan, light, fitted.plan().guard_texels());
      ASSERT_TRUE(look_up.ok()) << look_up.status();
      int num_shadowed = 0, num_lost = 0;
      std::map<int, int> num_asking;
      testing::ForEachReceiver(*surfaces,
                               readback.shadow_bits,
                               uint32_t{1} << light.shadow_bit,
                               [&](const Eigen::Vector3d& world) {
                                 const int map = look_up->At(world).map;
                                 ++num_shadowed;
                                 num_lost += map < 0 ? 1 : 0;
                                 ++num_asking[map];
                               });
      EXPECT_GT(num_shadowed, 1000);
      EXPECT_EQ(num_lost, 0);
      EXPECT_GE(num_asking.size(), 3u);
    }
  }
}

TEST(FitPlan, ClipMatricesAreOfEachMapInTheConventionAskedFor) {
  const v1::FitResult result =
      FitJson(Joined(kFitYard, {"--maps", "2", "--only", "sun", "--clip", "direct3d"}));
  ASSERT_EQ(result.lights_size(), 1);
  EXPECT_EQ(result.lights(0).clip().name(), "direct3d");
  for (const v1::PlanMap& map : result.lights(0).plan().maps()) {
    const Eigen::Matrix4d expected =
        ClipFromMap({map.map().width(), map.map().height()}, ClipConvention::Direct3D()) *
        MatrixOf(map.map_from_world());
    EXPECT_LE((MatrixOf(map.clip_from_world()) - expected).cwiseAbs().maxCoeff(),
              kMatrixTolerance * expected.cwiseAbs().maxCoeff());
  }
}

TEST(FitPlan, PrintsPlansBesideSingleMapsOfAsManyTexels) {
  const ProcessResult result =
      RunLightfit(Joined(kFitYard, {"--maps", "3", "--texels", "400x400"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* words : {"up to 3 maps for each light, 160000 texels in all",
                            "published",
                            "one map",
                            "plan",
                            "energy",
                            "both 400 x 400",
                            "shadow-edge",
                            "footprint, px",
                            "\n\nColumns: lightfit fit --help, or --legend here.\n"}) {
    EXPECT_THAT(result.out, HasSubstr(words));
  }
  int num_sun_rows = 0;
  for (const absl::string_view line : absl::StrSplit(result.out, '\n')) {
    num_sun_rows += absl::StartsWith(line, "sun ") ? 1 : 0;
    EXPECT_TRUE(absl::StartsWith(line, kYard) || line.size() <= 110) << line;
  }
  EXPECT_EQ(num_sun_rows, 3) << result.out;
}

TEST(FitPlan, SameInputGivesTheSameBytes) {
  std::string json[2], picture[2];
  for (int i = 0; i < 2; ++i) {
    const TemporaryFolder folder;
    const Arguments outputs = {
        "--json", folder.Path("out.json"), "--picture", folder.Path("out.png")};
    ASSERT_EQ(RunLightfit(Joined(Joined(kFitYard, {"--maps", "4"}), outputs)).exit_code, 0);
    json[i] = ReadFile(folder.Path("out.json"));
    picture[i] = ReadFile(folder.Path("out.png"));
  }
  EXPECT_EQ(json[0], json[1]);
  EXPECT_FALSE(picture[0].empty());
  EXPECT_TRUE(picture[0] == picture[1]);
}

// One map is what it always was.
TEST(FitPlan, OneMapIsTheFitWithoutAPlan) {
  const TemporaryFolder folder;
  const std::string one = folder.Path("one.json"), plain = folder.Path("plain.json");
  EXPECT_EQ(RunLightfit(Joined(kFitYard, {"--json", plain})).exit_code, 0);
  EXPECT_EQ(RunLightfit(Joined(kFitYard, {"--maps", "1", "--json", one})).exit_code, 0);
  EXPECT_EQ(ReadFile(one), ReadFile(plain));
  EXPECT_FALSE(ReadResult(one).has_plan_options());
}

// Maps of which the filter leaves nothing: what there is none of is a plan.
TEST(FitPlan, ALightWithoutAPlanSaysSo) {
  const ProcessResult result =
      RunLightfit(Joined(kFitRoom, {"--maps", "2", "--texels", "128", "--guard", "40"}));
  EXPECT_EQ(result.exit_code, 2);  // all three
  EXPECT_THAT(result.err, HasSubstr("no plan for light \"key\""));
  EXPECT_THAT(result.out, HasSubstr("no plan, see below"));
  EXPECT_THAT(result.err + result.out, Not(HasSubstr("no matrix")));
}

// A lamp among its receivers: without a plan its error says what would do, and that does.
TEST(FitPlan, ALampAmongItsReceiversHasAPlan) {
  const ProcessResult single = RunLightfit(kFitRoom);
  EXPECT_EQ(single.exit_code, 3);
  EXPECT_THAT(single.err,
              AllOf(HasSubstr("no matrix for light \"key\""),
                    HasSubstr("A plan of 2 maps (--maps 2) would do"),
                    Not(HasSubstr("\"sun\""))));
  const v1::FitResult result = FitJson(Joined(kFitRoom, {"--maps", "2"}));
  ASSERT_EQ(result.lights_size(), 3);
  for (const v1::LightResult& light : result.lights()) {
    EXPECT_EQ(light.status().code(), 0) << light.status().message();
    EXPECT_EQ(light.energies().has_one_map(), light.name() != "key");
    EXPECT_EQ(light.plan().maps_size(), 2);
  }
}

TEST(FitPlan, ChoosesBordersWhereTheReadBackKnows) {
  const std::string folder = RepositoryPath("../shared/readbacks/hall_180");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no read-backs at " << folder;
  const Arguments fit = {
      "fit", folder + "/0001.exr", "--lights", folder + "/scene.json", "--maps", "4"};
  int num_dark = 0;
  const v1::FitResult result = FitJson(fit);
  for (const v1::LightResult& light : result.lights()) {
    EXPECT_EQ(light.facing(), v1::FACING_SOURCE_GIVEN);
    EXPECT_EQ(light.border(), light.plan().border());
    num_dark += light.border() == v1::BORDER_DARK ? 1 : 0;
  }
  EXPECT_GE(num_dark, 1);
  EXPECT_THAT(RunLightfit(fit).out, AllOf(HasSubstr("light  border  maps"), HasSubstr("Border: ")));
}

TEST(FitPlan, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](const Arguments& more, const std::vector<std::string>& words) {
    SCOPED_TRACE(more.front());
    ExpectError(RunLightfit(Joined(kFitYard, more)), 1, words);
  };
  refused({"--texels", "64x64", "--map", "32x32", "--maps", "2"}, {"--texels", "--map"});
  refused({"--texels", "64x64"}, {"--texels", "--maps 2 or more", "--map"});
  refused({"--guard", "1"}, {"--guard", "--maps 2 or more"});
  refused({"--maps", "0"}, {"--maps", "1 to 32"});
  refused({"--maps", "33"}, {"--maps", "1 to 32"});
  refused({"--maps", "2", "--texels", "127"}, {"--texels 127, want 128 "});
  refused({"--maps", "2", "--texels", "many"}, {"--texels", "many"});
  refused({"--maps", "2", "--guard", "-1"}, {"--guard"});
  refused({"--maps", "2", "--map", "64x32", "--guard", "16"},
          {"--map 64x32: the --guard of 16 texels"});
  refused({"--maps", "2", "--search", "line"}, {"--maps", "--search"});
  refused({"--maps", "2", "--affine", "skewed"}, {"--maps", "--affine"});
  refused({"--maps", "2", "--as-published"}, {"--maps", "--as-published"});
  const TemporaryFolder folder;
  ExpectError(RunLightfit({"fit", "--summary", YardSummary(folder, "a.summary"), "--maps", "2"}),
              1,
              {"--maps", "--summary"});
}

// Who takes one matrix of each light must not take one of several for it.
TEST(FitPlan, ResultsWithSeveralMapsAreRefusedWhereOneIsWanted) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("plan.json");
  ASSERT_EQ(RunLightfit(Joined(kFitYard, {"--maps", "2", "--json", json})).exit_code, 0);
  ExpectError(RunLightfit({"summarize",
                           kYard,
                           "--lights",
                           kYardLights,
                           "--weigh-by",
                           json,
                           "-o",
                           folder.Path("out.summary")}),
              2,
              {json, "light \"sun\": has a plan of 2 maps", "--maps"});
}

}  // namespace
}  // namespace lightfit
