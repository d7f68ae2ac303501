// `lightfit shot` end to end: what it writes, held against the library's own calls.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "io/readback_exr.h"
#include "optimizer/energy/summary_total.h"
#include "optimizer/evaluate.h"
#include "optimizer/figures/stability.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/tracker.h"
#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr MapSize kMap = {300, 200};
const char* const kModes[] = {"per-frame", "tracked", "per-shot"};

ReadbackFile ReadBack(const BoxShot& shot, int frame) {
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(shot.FramePath(frame), shot.lights());
  EXPECT_TRUE(file.ok()) << file.status();
  return *std::move(file);
}

// Cells of the CSV by line, the names first.
std::vector<std::vector<std::string>> CsvCells(const std::string& path) {
  std::vector<std::vector<std::string>> cells;
  for (const absl::string_view line : absl::StrSplit(ReadFile(path), '\n', absl::SkipEmpty())) {
    cells.push_back(absl::StrSplit(line, ','));
  }
  return cells;
}

TEST(Shot, WritesEveryFrameInEveryMode) {
  const BoxShot shot(4);
  const ProcessResult result = shot.Run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("walk: 4 frames"),
                    HasSubstr("per-frame"),
                    HasSubstr("tracked"),
                    HasSubstr("per-shot.json"),
                    HasSubstr("all lights"),
                    Not(HasSubstr("resuming"))));
  for (const absl::string_view line : absl::StrSplit(result.out, '\n')) {
    EXPECT_FALSE(absl::EndsWith(line, " ")) << line;
    EXPECT_TRUE(absl::StrContains(line, shot.Output()) || line.size() <= 110) << line;
  }
  const std::map<std::string, std::string> files = FilesBelow(shot.Output());
  for (int frame = 0; frame < 4; ++frame) {
    for (const char* mode : kModes) {
      const v1::FitResult fit = ReadResult(shot.ResultPath(mode, frame));
      EXPECT_EQ(fit.shot().frame(), shot.FrameName(frame));
      EXPECT_EQ(fit.shot().number(), 998 + frame);
      ASSERT_EQ(fit.lights_size(), 2);
      for (const v1::LightResult& light : fit.lights()) {
        EXPECT_TRUE(light.has_clip_from_world());
        EXPECT_EQ(light.shot().has_crawl(), frame > 0);
      }
    }
    EXPECT_EQ(files.count("summaries/" + shot.FrameName(frame) + ".summary"), 1u);
  }
  EXPECT_EQ(files.count("shot.png"), 1u);
  // Three modes, a summary and its key for each frame; the shot's map, CSV and plot.
  EXPECT_EQ(files.size(), 4u * 5 + 3);
}

TEST(Shot, PerFrameIsWhatFitWouldGive) {
  const BoxShot shot(3);
  ASSERT_EQ(shot.Run({"--per-frame", "--quiet"}).exit_code, 0);
  for (int frame = 0; frame < 3; ++frame) {
    const ReadbackFile file = ReadBack(shot, frame);
    const v1::FitResult result = ReadResult(shot.ResultPath("per-frame", frame));
    for (size_t i = 0; i < shot.lights().size(); ++i) {
      const absl::StatusOr<LightMatrix> fit = FitLight(file.View(), shot.lights()[i], kMap);
      ASSERT_TRUE(fit.ok()) << fit.status();
      EXPECT_EQ(MatrixOf(result.lights(i).map_from_world()), fit->map_from_world);
    }
  }
}

TEST(Shot, TrackedIsWhatTheTrackerGives) {
  const BoxShot shot(6);
  ASSERT_EQ(shot.Run({"--tracked", "--stability", "0.3", "--quiet"}).exit_code, 0);
  Tracker tracker(TrackerOptions::ForStability(0.3));
  for (int frame = 0; frame < 6; ++frame) {
    const ReadbackFile file = ReadBack(shot, frame);
    const auto tracked = tracker.Update(file.View(), shot.lights(), kMap);
    const v1::FitResult result = ReadResult(shot.ResultPath("tracked", frame));
    for (size_t i = 0; i < tracked.size(); ++i) {
      ASSERT_TRUE(tracked[i].ok()) << tracked[i].status();
      const v1::LightResult& light = result.lights(i);
      EXPECT_EQ(MatrixOf(light.map_from_world()), tracked[i]->matrix.map_from_world);
      EXPECT_EQ(light.shot().frames_kept(), tracked[i]->frames_kept);
      EXPECT_EQ(light.shot().action() == v1::TRACKER_ACTION_FIRST, frame == 0);
    }
  }
}

TEST(Shot, FiguresOfAllModesAreByOneMeasure) {
  const BoxShot shot(3);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const ReadbackFile before = ReadBack(shot, 1), file = ReadBack(shot, 2);
  const Readback readback_before = before.View(), readback = file.View();
  for (const char* mode : kModes) {
    SCOPED_TRACE(mode);
    const v1::FitResult result_before = ReadResult(shot.ResultPath(mode, 1));
    const v1::FitResult result = ReadResult(shot.ResultPath(mode, 2));
    for (size_t i = 0; i < shot.lights().size(); ++i) {
      const Light& light = shot.lights()[i];
      const Eigen::Matrix4d map_before = MatrixOf(result_before.lights(i).map_from_world());
      const Eigen::Matrix4d map = MatrixOf(result.lights(i).map_from_world());
      const absl::StatusOr<Figures> figures = EvaluateMatrix(readback, light, map, kMap);
      ASSERT_TRUE(figures.ok()) << figures.status();
      EXPECT_EQ(result.lights(i).energies().final(), figures->energy);
      EXPECT_EQ(result.lights(i).footprint().p99(), figures->footprint.p99);
      EXPECT_EQ(result.lights(i).foretold_wrong().final(), figures->wrong_share);
      const absl::StatusOr<Crawl> crawl =
          MeasureCrawl({readback_before, map_before, kMap}, {readback, map, kMap}, light);
      ASSERT_TRUE(crawl.ok()) << crawl.status();
      EXPECT_GT(crawl->num_points, 0);
      EXPECT_EQ(result.lights(i).shot().crawl().num_points(), crawl->num_points);
      EXPECT_EQ(result.lights(i).shot().crawl().edge_crawl_px(), crawl->edge_crawl_px);
    }
  }
}

TEST(Shot, PerShotIsOneMatrixThatNeverCrawls) {
  const BoxShot shot(4);
  ASSERT_EQ(shot.Run({"--per-shot", "--quiet"}).exit_code, 0);
  const v1::FitResult whole = ReadResult(shot.Output() + "/per-shot.json");
  ASSERT_EQ(whole.lights_size(), 2);
  for (int i = 0; i < 2; ++i) {
    double sum = 0.0;
    for (int frame = 0; frame < 4; ++frame) {
      const v1::LightResult light = ReadResult(shot.ResultPath("per-shot", frame)).lights(i);
      EXPECT_EQ(MatrixOf(light.map_from_world()), MatrixOf(whole.lights(i).map_from_world()));
      EXPECT_LT(light.shot().crawl().phase_drift_texels(), kPhaseTolerance);
      sum += light.energies().final();
    }
    // Weights are one over footprints that are no less than a share of their mean, which is all
    // that the two sums differ by.
    EXPECT_NEAR(whole.lights(i).energies().final(), sum, 1e-3 * sum);
  }
}

// Squared footprints are what a sum of summaries knows exactly.
TEST(Shot, PerShotIsTheFitToTheSumOfAllFrames) {
  const BoxShot shot(4);
  ASSERT_EQ(shot.Run({"--per-shot", "--metric", "l2", "--quiet"}).exit_code, 0);
  const v1::FitResult whole = ReadResult(shot.Output() + "/per-shot.json");
  FitOptions options;
  options.metric = Metric::kL2;
  for (size_t i = 0; i < shot.lights().size(); ++i) {
    std::vector<Summary> summaries;
    for (int frame = 0; frame < 4; ++frame) {
      const absl::StatusOr<Summary> summary =
          Summarize(ReadBack(shot, frame).View(), shot.lights()[i], options);
      ASSERT_TRUE(summary.ok()) << summary.status();
      summaries.push_back(*summary);
    }
    const absl::StatusOr<Summary> sum = MergeSummaries(summaries, shot.lights()[i]);
    ASSERT_TRUE(sum.ok()) << sum.status();
    const absl::StatusOr<LightMatrix> fit = Fit(*sum, shot.lights()[i], kMap, options);
    ASSERT_TRUE(fit.ok()) << fit.status();
    EXPECT_EQ(MatrixOf(whole.lights(i).map_from_world()), fit->map_from_world);
  }
}

TEST(Shot, RoundsNeverMakeTheShotsMapWorse) {
  const BoxShot shot(4);
  ASSERT_EQ(shot.Run({"--per-shot", "--rounds", "0", "--quiet"}).exit_code, 0);
  const v1::FitResult none = ReadResult(shot.Output() + "/per-shot.json");
  ASSERT_EQ(shot.Run({"--per-shot", "--rounds", "3", "--quiet"}).exit_code, 0);
  const v1::FitResult three = ReadResult(shot.Output() + "/per-shot.json");
  for (int i = 0; i < 2; ++i) {
    EXPECT_LE(three.lights(i).energies().final(), none.lights(i).energies().final());
  }
}

TEST(Shot, CsvHasALineForEachModeFrameAndLight) {
  const BoxShot shot(3);
  ASSERT_EQ(shot.Run({"--quiet"}).exit_code, 0);
  const auto cells = CsvCells(shot.Output() + "/shot.csv");
  ASSERT_EQ(cells.size(), 1u + 3 * 3 * 2);
  EXPECT_EQ(cells[0][0], "mode");
  EXPECT_EQ(cells[0][7], "energy_ratio");
  EXPECT_EQ(cells[0][13], "edge_crawl_px");
  for (size_t i = 1; i < cells.size(); ++i) {
    ASSERT_EQ(cells[i].size(), cells[0].size());
    EXPECT_EQ(cells[i][0], kModes[(i - 1) / 6]);
    EXPECT_EQ(cells[i][1], shot.FrameName((i - 1) / 2 % 3));
    EXPECT_EQ(cells[i][3], shot.lights()[(i - 1) % 2].name);
    EXPECT_EQ(cells[i][4], "ok");
    EXPECT_TRUE(cells[i][0] != "per-frame" || cells[i][7] == "1");
    EXPECT_EQ(cells[i][13].empty(), cells[i][1] == shot.FrameName(0));
  }
  // A ratio needs the per-frame matrices.
  const BoxShot other(2);
  ASSERT_EQ(other.Run({"--tracked", "--quiet"}).exit_code, 0);
  for (const auto& line : CsvCells(other.Output() + "/shot.csv")) {
    EXPECT_TRUE(line[0] == "mode" || line[7].empty());
  }
  EXPECT_FALSE(std::filesystem::exists(other.Output() + "/per-frame"));
}

TEST(Shot, TakesListsAndFilesInOrder) {
  const BoxShot shot(3);
  WriteFile(shot.Path("late.txt"), "# the end of it\n\n  walk/walk.0999.exr\nwalk/walk.1000.exr\n");
  const std::vector<std::string> common = {
      "--lights", shot.LightsPath(), "--per-frame", "--quiet", "-o"};
  const auto run = [&](std::vector<std::string> inputs, const std::string& output) {
    inputs.insert(inputs.begin(), "shot");
    inputs.insert(inputs.end(), common.begin(), common.end());
    inputs.push_back(shot.Path(output));
    return RunLightfit(inputs);
  };
  const ProcessResult list = run({shot.Path("late.txt")}, "list");
  const ProcessResult files = run({shot.FramePath(1), shot.FramePath(2)}, "files");
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_EQ(files.exit_code, 0) << files.err;
  EXPECT_EQ(ReadFile(shot.Path("list/shot.csv")), ReadFile(shot.Path("files/shot.csv")));
  EXPECT_EQ(CsvCells(shot.Path("list/shot.csv"))[1][1], "walk.0999");
}

TEST(Shot, QuietPrintsNothingWhenAllIsWell) {
  const BoxShot shot(2);
  const ProcessResult result = shot.Run({"--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, IsEmpty());
}

// A camera file counts frames along with the list.
TEST(Shot, TakesCamerasFromASceneFile) {
  const std::string folder = RepositoryPath("../shared/readbacks/shot_walk");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no read-backs at " << folder;
  const TemporaryFolder output;
  const std::string lights = folder + "/scene.json";
  for (const char* name : {"given", "own"}) {
    std::vector<std::string> arguments = {"shot",
                                          folder + "/0003.exr",
                                          folder + "/0004.exr",
                                          "--lights",
                                          lights,
                                          "--per-frame",
                                          "--quiet",
                                          "-o",
                                          output.Path(name)};
    if (std::string(name) == "given") {
      arguments.insert(arguments.end(), {"--camera", lights, "--frame", "2"});
    }
    const ProcessResult result = RunLightfit(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  for (const char* frame : {"0003", "0004"}) {
    const std::string file = std::string("/per-frame/") + frame + ".json";
    const v1::LightResult given = ReadResult(output.Path("given") + file).lights(0);
    const v1::LightResult own = ReadResult(output.Path("own") + file).lights(0);
    // The two cameras differ by the single precision of the file's attributes.
    EXPECT_NEAR(given.energies().final(), own.energies().final(), 1e-2 * own.energies().final());
  }
}

TEST(Shot, ASingleCameraIsForAllFrames) {
  const BoxShot shot(2);
  ASSERT_EQ(shot.Run({"--per-frame", "--quiet"}).exit_code, 0);
  const v1::Camera camera = ReadResult(shot.ResultPath("per-frame", 1)).readback().camera();
  WriteFile(shot.Path("camera.json"), ProtoToJson(camera).value());
  const ProcessResult result =
      shot.Run({"--per-frame", "--quiet", "--camera", shot.Path("camera.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (int frame = 0; frame < 2; ++frame) {
    const v1::FitResult fit = ReadResult(shot.ResultPath("per-frame", frame));
    EXPECT_EQ(ProtoToJson(fit.readback().camera()).value(), ProtoToJson(camera).value());
  }
}

}  // namespace
}  // namespace lightfit
