// `lightfit fit` where the border of the map is chosen, a finer image helps, or samples are few.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "io/readback_exr_write.h"
#include "tests/cli/examples.h"
#include "tests/cli/summaries.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/process.h"
#include "wire/light_proto.h"
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
                    uint64_t camera_seed = 5) const {
    const SyntheticReadback image =
        Render(scene, RandomCamera(scene, camera_seed, width, height), lights);
    const absl::Status status = WriteReadbackExr(folder.Path(name), image.ViewWithFacing(), lights);
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
