// `lightfit fit` where the border of the map is chosen, a finer image helps, or samples are few.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "io/fine_cover_exr.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "io/readback_exr_write.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "partition/evaluate_plan.h"
#include "partition/plan.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/partition/receivers.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/process.h"
#include "wire/light_proto.h"
#include "wire/plan_proto.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// A room with two windows in three sizes, of a real renderer.
class FitHall : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const std::string& path : {hall_180, hall_750, lights}) {
      if (!std::filesystem::exists(path)) GTEST_SKIP() << "no read-back at " << path;
    }
  }

  const std::string hall_180 = RepositoryPath("../shared/readbacks/hall_180/0001.exr");
  const std::string hall_750 = RepositoryPath("../shared/readbacks/hall_750/0001.exr");
  const std::string lights = RepositoryPath("../shared/readbacks/hall_180/scene.json");
};

TEST_F(FitHall, WithACoverReadbackHasATableWithBorders) {
  const TemporaryFolder folder;
  const std::string with = folder.Path("with.json"), without = folder.Path("without.json");
  const ProcessResult result = RunLightfit(
      {"fit", hall_180, "--lights", lights, "--cover-readback", hall_750, "--json", with});
  EXPECT_EQ(result.err, "");
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("light  border "), HasSubstr("far outside"), HasSubstr("Border: ")));
  EXPECT_THAT(result.out, HasSubstr("within a factor of 1.8 of the foretold one.\n"));
  std::map<std::string, std::string> borders;
  for (const absl::string_view line : absl::StrSplit(result.out, '\n')) {
    const std::vector<std::string> cells = absl::StrSplit(line, ' ', absl::SkipEmpty());
    if (cells.size() == 12) borders[cells[0]] = cells[1];
  }
  ASSERT_EQ(RunLightfit({"fit", hall_180, "--lights", lights, "--json", without}).exit_code, 0);
  const v1::FitResult a = ReadResult(with), b = ReadResult(without);
  EXPECT_EQ(a.options().border(), v1::BORDER_CHOICE_AUTOMATIC);
  ASSERT_EQ(a.lights_size(), 3);
  ASSERT_EQ(b.lights_size(), 3);
  bool differs = false;
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(a.lights(i).name());
    EXPECT_EQ(a.lights(i).facing(), v1::FACING_SOURCE_GIVEN);
    const bool is_dark = a.lights(i).border() == v1::BORDER_DARK;
    EXPECT_EQ(borders[a.lights(i).name()], is_dark ? "dark" : "lit");
    if (a.lights(i).name() != "key") {
      EXPECT_TRUE(is_dark);
    }
    differs |= MatrixOf(a.lights(i).map_from_world()) != MatrixOf(b.lights(i).map_from_world());
  }
  EXPECT_TRUE(differs);
}

// Of a real renderer. Chosen by forecast: with the finer image fewer wrong pixels are foretold than
// of the plan that does not look at it, as the finer image tells of both.
TEST(FitCoverReadback, MakesPlansBetterByForecast) {
  const std::string coarse = RepositoryPath("../shared/readbacks/room_180_facing/0001.exr");
  const std::string fine = RepositoryPath("../shared/readbacks/room_750_facing/0001.exr");
  const std::string lights = RepositoryPath("../shared/readbacks/room_180_facing/scene.json");
  for (const std::string& path : {coarse, fine, lights}) {
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no read-back at " << path;
  }
  const TemporaryFolder folder;
  const std::string with = folder.Path("with.json"), without = folder.Path("without.json");
  const Arguments fit = {
      "fit", coarse, "--lights", lights, "--only", "sun", "--maps", "3", "--texels", "300x300"};
  const ProcessResult result = RunLightfit(Joined(fit, {"--cover-readback", fine, "--json", with}));
  EXPECT_EQ(result.err, "");
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("light  border  maps"));
  ASSERT_EQ(RunLightfit(Joined(fit, {"--json", without})).exit_code, 0);

  const std::vector<Light> all = ReadLightsFile(lights).value();
  const auto sun =
      std::find_if(all.begin(), all.end(), [](const Light& light) { return light.name == "sun"; });
  ASSERT_NE(sun, all.end());
  const ReadbackFile file = ReadReadbackExr(coarse, all).value();
  const FineCoverFile fine_file = ReadFineCoverExr(fine, all, {}, file).value();
  const FineCover cover = fine_file.View();
  Readback readback = file.View();
  readback.fine_cover = &cover;
  const auto foretold = [&](const std::string& json) {
    const v1::FitResult fitted = ReadResult(json);
    EXPECT_EQ(fitted.lights_size(), 1);
    const Plan plan = PlanFromProto(fitted.lights(0).plan(), "plan").value();
    return ForetellPlan(readback, *sun, plan, {}).value();
  };
  EXPECT_LT(foretold(with), foretold(without));
}

TEST_F(FitHall, RefusesACoverReadbackThatIsSmaller) {
  ExpectError(RunLightfit({"fit", hall_750, "--lights", lights, "--cover-readback", hall_180}),
              2,
              {hall_180, "180 x 180", "750 x 750"});
}

// Boxes on a floor, in files of any size.
struct BoxFiles {
  TemporaryFolder folder;
  BoxScene scene = MakeBoxScene(5);
  std::vector<Light> lights = RandomLights(scene, 5, 2);

  BoxFiles() {
    v1::LightList list;
    for (const Light& light : lights) *list.add_lights() = LightToProto(light);
    WriteFile(folder.Path("lights.json"), ProtoToJson(list).value());
  }
  std::string Write(const std::string& name,
                    int width,
                    int height,
                    uint64_t camera_seed = 5,
                    bool with_facing = true) const {
    const SyntheticReadback image =
        Render(scene, RandomCamera(scene, camera_seed, width, height), lights);
    const absl::Status status = WriteReadbackExr(
        folder.Path(name), with_facing ? image.ViewWithFacing() : image.View(), lights);
    EXPECT_TRUE(status.ok()) << status;
    return folder.Path(name);
  }
  ProcessResult Fit(const std::string& readback, const Arguments& more) const {
    return RunLightfit(Joined({"fit", readback, "--lights", folder.Path("lights.json")}, more));
  }
};

TEST(FitCoverReadback, MustBeLargerAndOfTheSameView) {
  const BoxFiles files;
  const std::string coarse = files.Write("coarse.exr", 96, 64);
  ExpectError(files.Fit(coarse, {"--cover-readback", files.Write("less.exr", 48, 32)}),
              2,
              {"less.exr", "48 x 32", "96 x 64"});
  ExpectError(files.Fit(coarse, {"--cover-readback", coarse}), 2, {"96 x 64"});
  ExpectError(files.Fit(coarse, {"--cover-readback", files.Write("other.exr", 192, 128, 6)}),
              2,
              {"other.exr", "another view"});
  ExpectError(files.Fit(coarse, {"--cover-readback", files.folder.Path("none.exr")}),
              1,
              {"--cover-readback", "none.exr"});
  const ProcessResult good =
      files.Fit(coarse, {"--cover-readback", files.Write("fine.exr", 192, 128)});
  EXPECT_EQ(good.exit_code, 0) << good.err;
}

// What a renderer does with the file: nothing dark that the finer image shows is outside of all
// maps where a lit border is asked for and facing is not known; without the finer image something
// is.
TEST(FitCoverReadback, PlansHaveRoomForWhatItShows) {
  const BoxFiles files;
  const std::string coarse = files.Write("coarse.exr", 60, 40, 5, /*with_facing=*/false);
  const std::string fine = files.Write("fine.exr", 480, 320, 5, /*with_facing=*/false);
  const std::string json = files.folder.Path("plan.json");
  const SyntheticReadback image =
      Render(files.scene, RandomCamera(files.scene, 5, 480, 320), files.lights);
  const Surfaces surfaces = *FindSurfaces(image.View(), LightMask(files.lights), {});
  const auto num_lost = [&](const Arguments& more) {
    const ProcessResult result = files.Fit(
        coarse, Joined({"--maps", "3", "--border", "lit", "--json", json, "--quiet"}, more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    const v1::FitResult fitted = ReadResult(json);
    EXPECT_EQ(fitted.lights_size(), static_cast<int>(files.lights.size()));
    int num_lost = 0;
    for (int l = 0; l < fitted.lights_size(); ++l) {
      const Light& light = files.lights[l];
      const Plan plan = PlanFromProto(fitted.lights(l).plan(), "plan").value();
      EXPECT_EQ(plan.maps.size(), 3u);
      const PlanLookUp look_up = PlanLookUp::Create(plan, light).value();
      testing::ForEachReceiver(
          surfaces,
          surfaces.readback.shadow_bits,
          uint32_t{1} << light.shadow_bit,
          [&](const Eigen::Vector3d& world) { num_lost += look_up.At(world).map < 0 ? 1 : 0; });
    }
    return num_lost;
  };
  EXPECT_EQ(num_lost({"--cover-readback", fine}), 0);
  EXPECT_GT(num_lost({}), 20);
}

// Less than was asked for is no error, but is said.
TEST(FitNotes, NameLightsThatHaveTheirFocusedMapForWantOfSamples) {
  const TemporaryFolder folder;
  const std::string json = folder.Path("out.json");
  const Arguments arguments = {"fit", kYard, "--lights", kYardLights, "--json", json};
  const ProcessResult few = RunLightfit(Joined(arguments, {"--min-samples", "1000000"}));
  EXPECT_EQ(few.exit_code, 0);
  const v1::FitResult result = ReadResult(json);
  ASSERT_EQ(result.lights_size(), 3);
  for (const v1::LightResult& light : result.lights()) {
    EXPECT_THAT(few.err,
                HasSubstr(absl::StrCat("warning: light \"",
                                       light.name(),
                                       "\": ",
                                       light.samples().used(),
                                       " usable shadow-edge pixels, fewer than 1000000 "
                                       "(--min-samples): its matrix is the focused map\n")));
    EXPECT_EQ(light.stop_reason(), v1::STOP_REASON_TOO_FEW_SAMPLES);
  }
  EXPECT_THAT(few.out, Not(HasSubstr("min-samples")));
  const ProcessResult enough = RunLightfit(arguments);
  EXPECT_EQ(enough.exit_code, 0);
  EXPECT_THAT(enough.err, IsEmpty());
  // Who asks for it gets it without a word.
  const ProcessResult asked =
      RunLightfit(Joined(arguments, {"--min-samples", "1000000", "--search", "focused"}));
  EXPECT_EQ(asked.exit_code, 0);
  EXPECT_THAT(asked.err, IsEmpty());
}

}  // namespace
}  // namespace lightfit
