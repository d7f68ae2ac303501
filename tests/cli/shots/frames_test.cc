// `lightfit shot`, `summarize` and `fit` end to end: frames by their numbers.

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "absl/strings/str_split.h"
#include "io/camera_file.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/fit.h"
#include "tests/cli/examples.h"
#include "tests/cli/shots/numbered_shot.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::NumberedShot;

// Cells of one light in one mode: number, drift and crawl by frame.
std::vector<std::vector<std::string>> Rows(const std::string& csv,
                                           const std::string& mode,
                                           const std::string& light) {
  std::vector<std::vector<std::string>> rows;
  for (const absl::string_view line : absl::StrSplit(ReadFile(csv), '\n', absl::SkipEmpty())) {
    const std::vector<std::string> cells = absl::StrSplit(line, ',');
    if (cells[0] == mode && cells[3] == light) rows.push_back(cells);
  }
  return rows;
}

std::vector<std::string> Numbers(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::string> numbers;
  for (const auto& row : rows) numbers.push_back(row[2]);
  return numbers;
}

class SharedCase : public ::testing::Test {
 protected:
  std::string Case(const std::string& name) const {
    return RepositoryPath("../shared/cases/") + name;
  }
};

TEST_F(SharedCase, AGapIsNamedAndCamerasAreByNumber) {
  const std::string folder = Case("shot_gap_and_camera_file");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no case at " << folder;
  const TemporaryFolder output;
  const std::string scene = folder + "/scene.json";
  const ProcessResult result = RunLightfit(
      {"shot", folder, "--camera", scene, "--lights", scene, "-o", output.Path("out"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("frames 1004-1006 are missing (3)"));
  const std::vector<Light> lights = *ReadLightsFile(scene);
  for (const int number : {1001, 1003, 1007, 1008}) {
    const std::string name = absl::StrCat(number);
    ReadbackExrOptions options;
    options.camera = ReadCameraFile(scene, FrameNumber::Whole(number - 1001))->camera;
    const auto file = ReadReadbackExr(folder + "/" + name + ".exr", lights, options);
    ASSERT_TRUE(file.ok()) << file.status();
    const v1::FitResult fit = ReadResult(output.Path("out/per-frame/" + name + ".json"));
    for (size_t i = 0; i < lights.size(); ++i) {
      const auto expected = FitLight(file->View(), lights[i], {1024, 1024});
      ASSERT_TRUE(expected.ok()) << expected.status();
      EXPECT_EQ(MatrixOf(fit.lights(static_cast<int>(i)).map_from_world()),
                expected->map_from_world);
    }
  }
  for (const char* mode : {"per-frame", "tracked", "per-shot"}) {
    const auto rows = Rows(output.Path("out/shot.csv"), mode, "sun");
    EXPECT_THAT(Numbers(rows), ElementsAre("1001", "1002", "1003", "1007", "1008"));
    EXPECT_FALSE(rows[2][12].empty());
    EXPECT_THAT(rows[3][12], IsEmpty()) << "drift over the gap";
    EXPECT_THAT(rows[3][13], IsEmpty()) << "crawl over the gap";
    EXPECT_FALSE(rows[4][12].empty());
  }
  // One frame alone does not say which of the eight cameras is its own.
  const std::string lost = folder + "/1007.exr", sum = output.Path("a.summary");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"fit", lost}, {"summarize", lost, "-o", sum}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--camera", scene, "--lights", scene});
    const ProcessResult refused = RunLightfit(arguments);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("scene.json"), HasSubstr("--frame N")));
    arguments.insert(arguments.end(), {"--frame", "6"});
    EXPECT_EQ(RunLightfit(arguments).exit_code, 0);
  }
}

TEST_F(SharedCase, FramesBelowZeroAreInOrder) {
  const std::string folder = Case("shot_negative_frames");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no case at " << folder;
  const TemporaryFolder output;
  const ProcessResult result = RunLightfit(
      {"shot", folder, "--lights", folder + "/lights.json", "-o", output.Path("out"), "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(Numbers(Rows(output.Path("out/shot.csv"), "tracked", "sun")),
              ElementsAre("-2", "-1", "0", "1", "2"));
  EXPECT_EQ(ReadResult(output.Path("out/tracked/shot.-002.json")).shot().number(), -2);
}

TEST(ShotFrames, BetweenFramesAreByValue) {
  const NumberedShot shot(5);
  const TemporaryFolder folder;
  const char* const names[] = {
      "shot.1001", "shot.1001.25", "shot.1001.5", "shot.1001.75", "shot.1002"};
  for (int i = 0; i < 5; ++i) shot.Link(i, folder.Path(absl::StrCat("in/", names[i], ".exr")));
  WriteFile(folder.Path("in/._shot.1001.exr"), "not an image");
  WriteFile(folder.Path("lights.json"), shot.LightsJson());
  const ProcessResult result = RunLightfit({"shot",
                                            folder.Path("in"),
                                            "--lights",
                                            folder.Path("lights.json"),
                                            "-o",
                                            folder.Path("out"),
                                            "--map",
                                            "256x256",
                                            "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(Numbers(Rows(folder.Path("out/shot.csv"), "per-frame", "sun")),
              ElementsAre("1001", "1001.25", "1001.5", "1001.75", "1002"));
  const v1::ShotInfo info = ReadResult(folder.Path("out/per-frame/shot.1001.25.json")).shot();
  EXPECT_EQ(info.number(), 1001);
  EXPECT_EQ(info.sub_frame(), 0.25);
}

// A frame that comes later makes two steps of the gap, and what it changes is computed again.
TEST(ShotFrames, ALostFrameThatComesLaterIsTaken) {
  const NumberedShot shot(4);
  const TemporaryFolder folder;
  for (const int i : {0, 1, 3}) shot.Link(i, folder.Path(absl::StrCat("in/", 1001 + i, ".exr")));
  WriteFile(folder.Path("lights.json"), shot.LightsJson());
  const std::vector<std::string> command = {
      "shot", folder.Path("in"), "--lights", folder.Path("lights.json"), "--map", "256x256", "-o"};
  const auto run = [&](const std::string& output) {
    std::vector<std::string> arguments = command;
    arguments.push_back(folder.Path(output));
    const ProcessResult result = RunLightfit(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  };
  EXPECT_THAT(run("out").err, HasSubstr("frame 1003 is missing: one map for the shot is not"));
  EXPECT_THAT(Rows(folder.Path("out/shot.csv"), "tracked", "sun")[2][12], IsEmpty());
  shot.Link(2, folder.Path("in/1003.exr"));
  const ProcessResult resumed = run("out");
  EXPECT_THAT(resumed.err, Not(HasSubstr("missing")));
  EXPECT_THAT(resumed.out, HasSubstr("resuming"));
  run("fresh");
  EXPECT_EQ(ReadFile(folder.Path("out/shot.csv")), ReadFile(folder.Path("fresh/shot.csv")));
  EXPECT_EQ(ReadFile(folder.Path("out/tracked/1004.json")),
            ReadFile(folder.Path("fresh/tracked/1004.json")));
}

// Copies a frame with its number in the header.
void WriteWithHeader(const NumberedShot& shot, int frame, int number, const std::string& path) {
  const TemporaryFolder folder;
  shot.Link(frame, folder.Path("a.exr"));
  Imf::InputFile input(folder.Path("a.exr").c_str());
  Imf::Header header = input.header();
  header.insert("frame", Imf::IntAttribute(number));
  Imf::OutputFile output(path.c_str(), header);
  output.copyPixels(input);
}

TEST(ShotFrames, HeadersNumberFramesWhoseNamesDoNot) {
  const NumberedShot shot(4);
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("in"));
  const std::vector<std::pair<std::string, int>> files = {{"late", 3}, {"early", 0}, {"mid", 1}};
  std::vector<std::string> entries;
  for (const auto& [name, frame] : files) {
    WriteWithHeader(shot, frame, 1001 + frame, folder.Path("in/" + name + ".exr"));
    entries.push_back(
        absl::StrFormat(R"({"frame": %d, %s})", 1001 + frame, NumberedShot::CameraJson(frame)));
  }
  WriteFile(folder.Path("scene.json"),
            NumberedShot::SceneJson(absl::StrCat("[", absl::StrJoin(entries, ","), "]")));
  WriteFile(folder.Path("lights.json"), shot.LightsJson());
  const auto run = [&](const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"shot",
                                          folder.Path(input),
                                          "--lights",
                                          folder.Path("lights.json"),
                                          "--camera",
                                          folder.Path("scene.json"),
                                          "--per-frame",
                                          "--map",
                                          "256x256",
                                          "--quiet",
                                          "-o",
                                          folder.Path("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  };
  const ProcessResult result = run("in");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("frame 1003 is missing"));
  EXPECT_THAT(Numbers(Rows(folder.Path("out/shot.csv"), "per-frame", "sun")),
              ElementsAre("1001", "1002", "1004"));
  const auto own = FitLight(shot.view(3).View(), shot.lights()[0], {256, 256});
  ASSERT_TRUE(own.ok()) << own.status();
  const Eigen::Matrix4d found =
      MatrixOf(ReadResult(folder.Path("out/per-frame/late.json")).lights(0).map_from_world());
  EXPECT_LE((found - own->map_from_world).norm(), 1e-6 * found.norm());
  // A name that contradicts its header chooses nothing by itself.
  std::filesystem::create_directory(folder.Path("renamed"));
  for (const int i : {0, 1}) {
    WriteWithHeader(shot, i, 1001 + i, folder.Path(absl::StrFormat("renamed/%04d.exr", 1002 + i)));
  }
  const ProcessResult doubtful = run("renamed");
  EXPECT_EQ(doubtful.exit_code, 2);
  EXPECT_THAT(doubtful.err,
              AllOf(HasSubstr("frame 1002 by its name and frame 1001 by its header"),
                    HasSubstr("--frame N")));
  EXPECT_EQ(run("renamed", {"--frame", "1001"}).exit_code, 0);
}

TEST(ShotFrames, PatternsThatMatchNothingNameTheFolder) {
  const NumberedShot shot(2);
  const TemporaryFolder folder;
  shot.Link(0, folder.Path("in/shot.1001.exr"));
  shot.Link(1, folder.Path("in/other.1001.exr"));
  WriteFile(folder.Path("lights.json"), shot.LightsJson());
  const auto run = [&](const char* verb, const std::string& input) {
    return RunLightfit({verb,
                        folder.Path(input),
                        "--lights",
                        folder.Path("lights.json"),
                        "-o",
                        folder.Path("out"),
                        "--quiet"});
  };
  for (const char* verb : {"shot", "summarize"}) {
    const ProcessResult nothing = run(verb, "in/walk.####.exr");
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_THAT(
        nothing.err,
        AllOf(HasSubstr("walk.####.exr: no file in "), HasSubstr("such as other.1001.exr")));
    const ProcessResult both = run(verb, "in");
    EXPECT_EQ(both.exit_code, 2);
    EXPECT_THAT(both.err,
                AllOf(HasSubstr("other.1001.exr and "), HasSubstr("are both frame 1001")));
    EXPECT_EQ(run(verb, "in/shot.%04d.exr").exit_code, 0);
    std::filesystem::remove_all(folder.Path("out"));
  }
}

}  // namespace
}  // namespace lightfit
