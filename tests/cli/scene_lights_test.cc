// Lights files of whole scenes: what is of no use to a read-back does not refuse the rest.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "tests/cli/examples.h"
#include "tests/io/exr_file.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// The yard's three lights among others.
constexpr char kSceneTail[] = R"(, {"name": "env", "type": "DOME"},
    {"name": "panel", "type": "AREA", "position": [1, 2, 3], "direction": [0, 0, -1]}]})";

class SceneLights : public ::testing::Test {
 protected:
  // The yard's lights file with `more` at its end.
  std::string LightsWith(const std::string& more) const {
    std::string text = R"({"lights": [)";
    const auto lights = ReadLightsFile(kYardLights);
    EXPECT_TRUE(lights.ok());
    for (const Light& light : *lights) {
      const bool is_point = light.kind == Light::Kind::kPoint;
      const Eigen::Vector3d& v = is_point ? light.position : light.direction;
      absl::StrAppend(&text, light.shadow_bit > 0 ? ", " : "", Entry(light.name, is_point, v));
    }
    return Write("lights.json", text + more);
  }

  static std::string Entry(const std::string& name, bool is_point, const Eigen::Vector3d& v) {
    return absl::StrFormat(R"({"name": "%s", "%s": [%.17g, %.17g, %.17g]})",
                           name,
                           is_point ? "position" : "direction",
                           v.x(),
                           v.y(),
                           v.z());
  }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.Path(name), std::ios::binary) << text;
    return folder_.Path(name);
  }

  ProcessResult Fit(const std::string& exr, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"fit", exr, "--json", folder_.Path("out.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  TemporaryFolder folder_;
};

TEST_F(SceneLights, DomesAndAreasFailAloneAndTheRestIsAsWithoutThem) {
  const ProcessResult alone = Fit(kYard, {"--lights", kYardLights});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const v1::FitResult expected = ReadResult(folder_.Path("out.json"));
  const ProcessResult result = Fit(kYard, {"--lights", LightsWith(kSceneTail)});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("DOME"), HasSubstr("AREA")));
  const v1::FitResult found = ReadResult(folder_.Path("out.json"));
  ASSERT_EQ(found.lights_size(), 5);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(MatrixOf(found.lights(i).map_from_world()),
              MatrixOf(expected.lights(i).map_from_world()));
  }
  EXPECT_EQ(found.lights(3).name(), "env");
  EXPECT_NE(found.lights(3).status().code(), 0);
  EXPECT_EQ(found.lights(3).light().direction_size(), 0);  // none is made up
}

TEST_F(SceneLights, WithOnlyTheOthersDoNotMatter) {
  const std::string lights = LightsWith(kSceneTail);
  EXPECT_EQ(Fit(kYard, {"--lights", lights, "--only", "sun"}).exit_code, 0);
  const ProcessResult none = Fit(kYard, {"--lights", lights, "--only", "env"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("DOME"));
  const ProcessResult unknown = Fit(kYard, {"--lights", lights, "--only", "sunn"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, AllOf(HasSubstr("env, panel"), HasSubstr("did you mean \"sun\"?")));
  // A light of the command line takes the place of one that is of no use.
  const ProcessResult replaced = Fit(
      kYard, {"--lights", lights, "--light", "env=sun:0,0,-1", "--only", "sun", "--only", "env"});
  EXPECT_EQ(replaced.exit_code, 3);
  EXPECT_THAT(replaced.err, AllOf(HasSubstr("shadow.env"), Not(HasSubstr("DOME"))));
}

// 34 lights, each with a channel of its own that is one of the yard's: more than one word has bits
// for.
TEST_F(SceneLights, MoreLightsThanBitsAreFittedAll) {
  const auto lights = ReadLightsFile(kYardLights);
  ASSERT_TRUE(lights.ok());
  const auto yard = ReadReadbackExr(kYard, *lights);
  ASSERT_TRUE(yard.ok()) << yard.status();
  testing::ExrPart part;
  part.width = part.data_width = yard->camera.width;
  part.height = part.data_height = yard->camera.height;
  const auto at = [&](int x, int y) { return static_cast<size_t>(y) * part.width + x; };
  part.channels = {{"Z", Imf::FLOAT, [&](int x, int y) { return yard->depth[at(x, y)]; }}};
  std::string text = R"({"lights": [)";
  constexpr int kNumLights = 34;
  for (int i = 0; i < kNumLights; ++i) {
    const Light& light = (*lights)[i % lights->size()];
    const bool is_point = light.kind == Light::Kind::kPoint;
    const std::string name = absl::StrFormat("l%02d", i);
    absl::StrAppend(&text,
                    i > 0 ? ", " : "",
                    Entry(name, is_point, is_point ? light.position : light.direction));
    part.channels.push_back({"shadow." + name, Imf::HALF, [&yard, &light, at](int x, int y) {
                               return yard->shadow_bits[at(x, y)] >> light.shadow_bit & 1U;
                             }});
  }
  testing::WriteExr(folder_.Path("frame.exr"), {part});
  const std::vector<std::string> flags = {
      "--lights", Write("many.json", text + "]}"), "--camera", kYardLights, "--search", "focused"};
  const ProcessResult result = Fit(folder_.Path("frame.exr"), flags);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const v1::FitResult found = ReadResult(folder_.Path("out.json"));
  ASSERT_EQ(found.lights_size(), kNumLights);
  for (int i = 0; i < kNumLights; ++i) {
    EXPECT_EQ(found.lights(i).name(), absl::StrFormat("l%02d", i));
    EXPECT_EQ(MatrixOf(found.lights(i).map_from_world()),
              MatrixOf(found.lights(i % static_cast<int>(lights->size())).map_from_world()));
  }
  std::vector<std::string> two = flags;
  two.insert(two.end(), {"--only", "l33", "--only", "l02"});
  EXPECT_EQ(Fit(folder_.Path("frame.exr"), two).exit_code, 0);
  // Others say how to go on.
  const ProcessResult summarized = RunLightfit({"summarize",
                                                folder_.Path("frame.exr"),
                                                "--lights",
                                                folder_.Path("many.json"),
                                                "-o",
                                                folder_.Path("out.summary")});
  EXPECT_EQ(summarized.exit_code, 2);
  EXPECT_THAT(summarized.err, AllOf(HasSubstr("34 of them"), HasSubstr("--only NAME")));
}

TEST_F(SceneLights, FilesWithByteOrderMarksAndUtf16AreRead) {
  std::ifstream file(kYardLights, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  for (const std::string& bytes : {"\xEF\xBB\xBF" + text, wide}) {
    const std::string path = Write("marked.json", bytes);
    const ProcessResult result =
        Fit(kYard, {"--lights", path, "--camera", path, "--search", "focused"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
}

TEST_F(SceneLights, TheCasesOfLightsFilesComeOutAsTheySay) {
  const std::string cases = RepositoryPath("../shared/cases/");
  if (!std::filesystem::exists(cases)) GTEST_SKIP() << "no ../shared/cases";
  const std::string others = cases + "lights_file_with_others/";
  const ProcessResult all = Fit(others + "frame.exr", {"--lights", others + "lights.json"});
  EXPECT_EQ(all.exit_code, 3);
  EXPECT_THAT(all.err, HasSubstr("DOME"));
  EXPECT_EQ(
      Fit(others + "frame.exr", {"--lights", others + "lights.json", "--only", "sun"}).exit_code,
      0);
  EXPECT_EQ(Fit(others + "frame.exr",
                {"--lights", others + "lights_42.json", "--only", "sun", "--only", "lamp"})
                .exit_code,
            0);
  const std::string marks = cases + "json_byte_order_mark/";
  for (const char* lights : {"lights.json", "lights_utf16.json"}) {
    EXPECT_EQ(Fit(marks + "frame.exr", {"--lights", marks + lights}).exit_code, 0) << lights;
  }
}

TEST_F(SceneLights, TheSunFarFromTheOriginIsAsTightAsAtIt) {
  const std::string far = RepositoryPath("../shared/cases/sun_far_from_origin/");
  if (!std::filesystem::exists(far)) GTEST_SKIP() << "no ../shared/cases";
  double energies[2] = {};
  for (int i = 0; i < 2; ++i) {
    const ProcessResult result = Fit(far + "frame.exr",
                                     {"--lights",
                                      far + "lights.json",
                                      "--camera",
                                      far + (i == 0 ? "camera_at_origin.json" : "camera.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    energies[i] = ReadResult(folder_.Path("out.json")).lights(0).energies().final();
  }
  EXPECT_GT(energies[0], 0.0);
  EXPECT_NEAR(energies[1], energies[0], 1e-4 * energies[0]);
}

}  // namespace
}  // namespace lightfit
