// From a real scene to a judged matrix in three commands: render, fit, compare.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "absl/strings/str_split.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

struct SceneView {
  const char* name;
  const char* camera;
  const char* sun;
};

void PrintTo(const SceneView& view, std::ostream* out) { *out << view.name; }

class ThreeCommands : public ::testing::TestWithParam<SceneView> {};

// Column "wrong_ideal" of every method.
std::map<std::string, int> WrongPixelsOf(const std::string& csv) {
  constexpr int kMethod = 5, kWrongIdeal = 7;
  std::map<std::string, int> wrong;
  for (const absl::string_view line : absl::StrSplit(csv, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> cells = absl::StrSplit(line, ',');
    if (cells[kMethod] != "method") wrong[cells[kMethod]] = std::atoi(cells[kWrongIdeal].c_str());
  }
  return wrong;
}

// The matrix that `fit` writes is as good as the one that `compare` fits itself, and better than
// the focused map.
TEST_P(ThreeCommands, RenderFitAndCompareAgree) {
  const std::string scene =
      RepositoryPath(std::string("../shared/scenes/") + GetParam().name + ".glb");
  if (!std::filesystem::exists(scene)) GTEST_SKIP() << "no scene at " << scene;
  const TemporaryFolder folder;
  const std::string exr = folder.Path("frame.exr"), json = folder.Path("ours.json");
  const std::string csv = folder.Path("compare.csv");
  const std::string camera = std::string("--camera=") + GetParam().camera;
  const std::string sun = std::string("sun=sun:") + GetParam().sun;

  const ProcessResult render =
      RunLightfit({"render", scene, camera, "--light", sun, "--size", "120x120", "-o", exr});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  const ProcessResult fit =
      RunLightfit({"fit", exr, "--light", sun, "--map", "200x200", "--json", json});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProcessResult compare = RunLightfit({"compare",
                                             scene,
                                             camera,
                                             "--light",
                                             sun,
                                             "--readback",
                                             "120x120",
                                             "--screen",
                                             "300x300",
                                             "--map",
                                             "200x200",
                                             "--matrix",
                                             "ours=" + json,
                                             "--csv",
                                             csv});
  ASSERT_EQ(compare.exit_code, 0) << compare.err;
  std::map<std::string, int> wrong = WrongPixelsOf(ReadFile(csv));
  ASSERT_EQ(wrong.count("ours"), 1u);
  // The camera goes through the file; a pixel at the edge of a texel may fall to the other side.
  EXPECT_NEAR(wrong["ours"], wrong["lightfit"], 3);
  EXPECT_LT(wrong["lightfit"], wrong["focused"]);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes,
    ThreeCommands,
    ::testing::Values(SceneView{"sponza_atrium", "-11.5,1.7,0.3:6,4.5,-0.3:60", "0.3,-1,0.2"},
                      SceneView{"denhaag_city", "-200,90,250:120,0,-120:50", "0.6,-0.5,-0.3"},
                      SceneView{"forest_valley", "60,25,120:0,4,0:50", "0.5,-0.6,0.2"},
                      SceneView{"objects_floor", "3,1.8,-3.2:-0.4,0.4,0.2:55", "-0.5,-1,0.3"},
                      SceneView{"hotel_room", "-2.5,1.6,-3:2,0.8,2:65", "-0.1,-0.3,1"},
                      SceneView{"shadow_columns", "-60,8,18:60,1,-4:60", "0.5,-0.6,-0.4"}),
    [](const ::testing::TestParamInfo<SceneView>& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightfit
