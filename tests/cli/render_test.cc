// `lightfit render`, end to end: from a scene to a read-back that `lightfit fit` takes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "tests/cli/examples.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/scenes/glb_bytes.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kScene = "generate:objects=10,triangles=3000";
const std::string kView = "0,1.7,18:0,0.5,0";

ProcessResult RenderGenerated(std::vector<std::string> more) {
  std::vector<std::string> arguments = {"render", kScene, "--camera", kView};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunLightfit(arguments);
}

void ExpectError(const ProcessResult& result, int exit_code, const std::string& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(result.err, AllOf(StartsWith("lightfit: error: "), HasSubstr(words)));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST(Render, WritesAReadbackThatFitTakes) {
  const TemporaryFolder folder;
  const std::string exr = folder.Path("a.exr"), lights = folder.Path("a.json");
  const ProcessResult render = RenderGenerated({"--light",
                                                "low=sun:1,-0.6,0.3",
                                                "--random-lights",
                                                "1",
                                                "--size",
                                                "90x60",
                                                "-o",
                                                exr,
                                                "--lights-out",
                                                lights});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  EXPECT_THAT(render.out, AllOf(HasSubstr("90x60"), HasSubstr("low"), HasSubstr("sun001")));
  EXPECT_THAT(folder.Files(), ElementsAre("a.exr", "a.json"));
  const auto written = ReadLightsFile(lights);
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ((*written)[0].direction, Eigen::Vector3d(1, -0.6, 0.3));
  const auto readback = ReadReadbackExr(exr, *written);
  ASSERT_TRUE(readback.ok()) << readback.status();
  EXPECT_EQ(readback->facing_lights, 3u);
  const std::string json = folder.Path("fit.json");
  const ProcessResult fit = RunLightfit({"fit", exr, "--lights", lights, "--json", json});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_EQ(ReadResult(json).lights_size(), 2);
}

TEST(Render, WritesTheSameBytesEveryTime) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    const ProcessResult result = RenderGenerated({"--light",
                                                  "low=sun:1,-0.6,0.3",
                                                  "--size",
                                                  "40x30",
                                                  "-o",
                                                  folder.Path(std::string(name) + ".exr"),
                                                  "--picture",
                                                  folder.Path(std::string(name) + ".png"),
                                                  "--picture-size",
                                                  "80x60",
                                                  "--quiet"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
  }
  // Not EXPECT_EQ, which would print both.
  EXPECT_TRUE(ReadFile(folder.Path("a.exr")) == ReadFile(folder.Path("b.exr")));
  EXPECT_TRUE(ReadFile(folder.Path("a.png")) == ReadFile(folder.Path("b.png")));
}

TEST(Render, TakesTheCameraOfASceneFileAtAnySize) {
  const TemporaryFolder folder;
  WriteFile(folder.Path("a.obj"), "v -90 -90 0\nv 90 -90 0\nv 90 90 0\nv -90 90 0\nf 1 2 3 4\n");
  const std::vector<std::string> arguments = {"render",
                                              folder.Path("a.obj"),
                                              "--camera",
                                              kYardLights,
                                              "--light",
                                              "key=point:0,0,9",
                                              "-o",
                                              folder.Path("a.exr"),
                                              "--size"};
  std::vector<std::string> square = arguments, wide = arguments;
  square.emplace_back("64x64");
  wide.emplace_back("64x32");
  const ProcessResult result = RunLightfit(square);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("light \"key\": casts no shadow"));
  ExpectError(RunLightfit(wide), 2, "180x180, 64x32 is asked for");
}

// Boxes on a floor with a camera half as wide as high, and a sun.
std::string TallScene() {
  const Scene scene = BoxesOnFloor();
  std::vector<float> positions;
  std::vector<uint32_t> corners;
  for (const Eigen::Vector3f& vertex : scene.vertices) {
    positions.insert(positions.end(), vertex.data(), vertex.data() + 3);
  }
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    corners.insert(corners.end(), triangle.data(), triangle.data() + 3);
  }
  const size_t num_bytes = sizeof(float) * positions.size();
  return testing::GlbOf(
      absl::StrCat(
          R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2]}], "scene": 0,
          "extensionsUsed": ["KHR_lights_punctual"],
          "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional"}]}},
          "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 2, 11]},
            {"name": "sun", "rotation": [-0.42, 0, 0, 0.91],
             "extensions": {"KHR_lights_punctual": {"light": 0}}}],
          "cameras": [{"type": "perspective",
            "perspective": {"yfov": 1, "znear": 0.1, "aspectRatio": 0.5}}],
          "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
          "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": )",
          scene.vertices.size(),
          R"(}, {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": )",
          corners.size(),
          R"(}], "bufferViews": [{"buffer": 0, "byteLength": )",
          num_bytes,
          R"(}, {"buffer": 0, "byteOffset": )",
          num_bytes,
          R"(, "byteLength": )",
          sizeof(uint32_t) * corners.size(),
          R"(}], "buffers": [{"byteLength": )",
          num_bytes + sizeof(uint32_t) * corners.size(),
          "}]}"),
      testing::BytesOf(positions) + testing::BytesOf(corners));
}

// All verbs that render take the shape of their image from the camera, where no size is asked for.
TEST(Render, AndCompareTakeTheShapeOfTheImageFromTheScenesCamera) {
  const TemporaryFolder folder;
  const std::string scene = folder.Path("tall.glb"), exr = folder.Path("a.exr");
  WriteFile(scene, TallScene());
  const ProcessResult render = RunLightfit({"render", scene, "-o", exr});
  EXPECT_EQ(render.exit_code, 0) << render.err;
  EXPECT_THAT(render.out, HasSubstr("90x180 pixels"));
  const std::vector<std::string> words = {
      "compare", scene, "--map", "64x64", "--phases", "1", "--search", "focused"};
  const ProcessResult compare = RunLightfit(words);
  EXPECT_EQ(compare.exit_code, 0) << compare.err;
  EXPECT_THAT(compare.out, HasSubstr("screen 375 x 750 pixels, read-back 127 x 255 pixels"));
  // The camera of another file counts, and what was asked for.
  std::vector<std::string> other = words, asked = words, square = words;
  other.insert(other.end(), {"--camera", kYardLights});
  const ProcessResult of_yard = RunLightfit(other);
  EXPECT_THAT(of_yard.out, HasSubstr("screen 750 x 750 pixels")) << of_yard.err;
  asked.insert(asked.end(), {"--screen", "60x120"});
  EXPECT_THAT(RunLightfit(asked).out, HasSubstr("screen 60 x 120 pixels"));
  square.insert(square.end(), {"--screen", "100x100"});
  ExpectError(RunLightfit(square), 2, "its frame is 0.5 times as wide as high");
  const ProcessResult tune =
      RunLightfit({"tune", scene, "--map", "64x64", "--evaluations", "1", "--search", "focused"});
  EXPECT_THAT(tune.out, HasSubstr("screen 375 x 750 pixels")) << tune.err;
}

TEST(Render, SaysWhatIsWrongWithTheScene) {
  const TemporaryFolder folder;
  const auto render = [&](const std::string& scene) {
    return RunLightfit({"render",
                        scene,
                        "--camera",
                        kView,
                        "--light",
                        "a=sun:0,-1,0",
                        "-o",
                        folder.Path("a.exr")});
  };
  ExpectError(render(folder.Path("none.glb")), 2, "no such file");
  ExpectError(render(kYard), 2, "want .glb");
  WriteFile(folder.Path("empty.obj"), "");
  ExpectError(render(folder.Path("empty.obj")), 2, "empty");
  WriteFile(folder.Path("flat.obj"), "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  ExpectError(render(folder.Path("flat.obj")), 2, "area");
  ExpectError(render("generate:objects=0"), 2, "objects = 0");
  ExpectError(render("generate:object=1"), 1, "did you mean \"objects\"");
  EXPECT_THAT(folder.Files(), ElementsAre("empty.obj", "flat.obj"));
}

TEST(Render, SaysWhatIsWrongWithCameraLightsAndOutputs) {
  const TemporaryFolder folder;
  const std::string exr = folder.Path("a.exr");
  const auto render = [&](const std::string& camera, const std::string& light) {
    return RunLightfit({"render", kScene, "--camera", camera, "--light", light, "-o", exr});
  };
  const std::string sun = "a=sun:0,-1,0";
  ExpectError(render("0,1.7,18:0,9,99", sun), 2, "sees nothing");
  ExpectError(render("0,1.7,18:0,1.7,18", sun), 2, "eye and target");
  ExpectError(render("0,5,18:0,1,18", sun), 2, "--up");
  ExpectError(render("0,1.7:0,0,0", sun), 1, "0,1.7:0,0,0");
  ExpectError(render("nothere.json", sun), 2, "nothere.json");
  ExpectError(render(kView, "a=sun:0,0,0"), 1, "direction");
  ExpectError(RenderGenerated({"-o", exr}), 2, "no lights");
  ExpectError(RenderGenerated({"--random-lights", "33", "-o", exr}), 2, "at most 32");
  ExpectError(RenderGenerated({"--random-lights", "1"}), 2, "nothing to write");
  ExpectError(
      RenderGenerated({"--random-lights", "1", "-o", folder.Path("no/a.exr")}), 2, "no folder");
  ExpectError(RenderGenerated({"--random-lights", "1", "-o", exr, "--picture-light", "sun01"}),
              2,
              "did you mean \"sun001\"");
  ExpectError(RenderGenerated({"--random-lights", "1", "-o", exr, "--size", "0x9"}), 1, "0x9");
  EXPECT_THAT(folder.Files(), IsEmpty());
}

TEST(Render, ALightThatLightsNothingIsSaidAndWritten) {
  const TemporaryFolder folder;
  const ProcessResult result = RenderGenerated(
      {"--light", "under=sun:0,1,0", "--size", "30x20", "-o", folder.Path("a.exr"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: light \"under\""));
  EXPECT_THAT(folder.Files(), ElementsAre("a.exr"));
}

}  // namespace
}  // namespace lightfit
