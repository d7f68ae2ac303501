// `lightfit fit --footprint` and `--csv`: the figures of every pixel, and of every light.

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "io/readback_exr_write.h"
#include "tests/cli/examples.h"
#include "tests/cli/exr_pixels.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::PlaneReadback;

// A floor whose every point is known without a depth buffer.
Eigen::Vector3d FloorPoint(const Camera& camera, double column, double row) {
  const Eigen::Matrix3d world_from_camera =
      camera.camera_from_world.topLeftCorner<3, 3>().transpose();
  const Eigen::Vector3d eye = -world_from_camera * camera.camera_from_world.topRightCorner<3, 1>();
  const Eigen::Vector3d ray =
      world_from_camera * camera.screen_from_camera.inverse() * Eigen::Vector3d(column, row, 1.0);
  return eye - eye.z() / ray.z() * ray;
}

// Pixels per texel by central differences of the map's own coordinates along the floor.
double FootprintByDifferences(const Camera& camera,
                              const Eigen::Matrix4d& map_from_world,
                              double column,
                              double row) {
  constexpr double kStep = 1e-3;  // pixels
  const auto texel = [&](double dx, double dy) -> Eigen::Vector2d {
    const Eigen::Vector4d map =
        map_from_world * FloorPoint(camera, column + dx, row + dy).homogeneous();
    return map.head<2>() / map.w();
  };
  Eigen::Matrix2d J_map_screen;
  J_map_screen.col(0) = (texel(kStep, 0) - texel(-kStep, 0)) / (2 * kStep);
  J_map_screen.col(1) = (texel(0, kStep) - texel(0, -kStep)) / (2 * kStep);
  return std::sqrt(0.5) * J_map_screen.inverse().norm();
}

TEST(FitFootprint, IsWhatDifferencesAlongTheFloorSay) {
  const TemporaryFolder folder;
  const Camera camera = testing::FloorCamera(60, 45);
  PlaneReadback floor = testing::FloorReadback(camera);
  // A disc of shadow, and a corner of sky.
  floor.Cast(0, [](int x, int y) { return std::hypot(x - 30.2, y - 24.7) < 9.0; });
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) floor.depth[floor.Index(x, y)] = 1e10F;
  }
  const Light sun = Light::Directional("sun.1", {0.3, 0.4, -1.0}, 0);
  ASSERT_TRUE(WriteReadbackExr(folder.Path("floor.exr"), floor.View(), {sun}).ok());
  const ProcessResult result = RunLightfit({"fit",
                                            folder.Path("floor.exr"),
                                            "--light",
                                            "sun.1=sun:0.3,0.4,-1",
                                            "--map",
                                            "64x64",
                                            "--json",
                                            folder.Path("fit.json"),
                                            "--footprint",
                                            folder.Path("pixels.exr")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const v1::FitResult fit = ReadResult(folder.Path("fit.json"));
  const Eigen::Matrix4d map_from_world = MatrixOf(fit.lights(0).map_from_world());
  const ExrPixels pixels = ReadExrPixels(folder.Path("pixels.exr"));
  ASSERT_EQ(pixels.width, 60);
  ASSERT_EQ(pixels.height, 45);
  ASSERT_EQ(pixels.channels.size(), 2U);
  const std::vector<float>& footprints = pixels.channels.at("footprint.sun.1");
  const std::vector<float>& wrong = pixels.channels.at("wrong.sun.1");

  // The depths of the read-back are floats, and slopes come from their differences.
  constexpr double kShare = 1e-3;
  int num_rated = 0;
  double sum_wrong = 0.0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      const size_t i = floor.Index(x, y);
      ASSERT_TRUE(std::isfinite(footprints[i]) && std::isfinite(wrong[i])) << x << ", " << y;
      EXPECT_GE(wrong[i], 0.0F);
      EXPECT_LE(wrong[i], 1.0F);
      sum_wrong += wrong[i];
      if (x < 8 && y < 6) {
        EXPECT_EQ(footprints[i], 0.0F) << x << ", " << y;
        EXPECT_EQ(wrong[i], 0.0F) << x << ", " << y;
      }
      if (footprints[i] == 0.0F) continue;
      ++num_rated;
      const double expected = FootprintByDifferences(camera, map_from_world, x + 0.5, y + 0.5);
      EXPECT_NEAR(footprints[i] / expected, 1.0, kShare) << x << ", " << y;
      // Farther from the disc's edge than a texel and the next pixel reach nothing can be wrong.
      const double from_edge = std::abs(std::hypot(x - 30.2, y - 24.7) - 9.0);
      if (from_edge > 1.5 * footprints[i] + 2.0) {
        EXPECT_EQ(wrong[i], 0.0F) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(num_rated, 58 * 43 - 48 - 40);  // all but the outermost and those beside the sky
  // In all they are the share that the table has.
  EXPECT_NEAR(sum_wrong / (60.0 * 45.0), fit.lights(0).foretold_wrong().final(), 1e-6);

  // The camera goes with them.
  const Imf::InputFile readback(folder.Path("floor.exr").c_str());
  const Imf::InputFile written(folder.Path("pixels.exr").c_str());
  for (const char* name : {"worldToCamera", "worldToNDC"}) {
    EXPECT_NE(written.header().find(name), written.header().end()) << name;
  }
  EXPECT_EQ(written.header().dataWindow(), readback.header().dataWindow());
}

TEST(FitFootprint, OfAPlanIsThatOfTheMapAskedAndTakesOneChannelPerLight) {
  const TemporaryFolder folder;
  const auto fit = [&](const std::vector<std::string>& more, const std::string& exr) {
    std::vector<std::string> arguments = {
        "fit", kYard, "--lights", kYardLights, "--only", "sun", "--footprint", exr, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = RunLightfit(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return ReadExrPixels(exr);
  };
  const ExrPixels one = fit({"--map", "512x512"}, folder.Path("one.exr"));
  const ExrPixels plan = fit({"--maps", "4", "--texels", "512x512"}, folder.Path("plan.exr"));
  ASSERT_EQ(plan.channels.size(), 2U);
  EXPECT_GT(one.Sum("wrong.sun"), 0.0);
  EXPECT_LT(plan.Sum("wrong.sun"), one.Sum("wrong.sun"));
  EXPECT_NE(plan.channels.at("footprint.sun"), one.channels.at("footprint.sun"));
}

TEST(FitFootprint, NeedsAFolderAndARoomInIt) {
  const ProcessResult result = RunLightfit(
      {"fit", kYard, "--lights", kYardLights, "--footprint", "/no/such/folder/out.exr"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--footprint /no/such/folder/out.exr: there is no folder"));
}

// The cells of each line by the names of the first.
std::vector<std::map<std::string, std::string>> RowsOf(const std::string& csv) {
  std::vector<std::map<std::string, std::string>> rows;
  std::vector<std::string> names;
  for (const absl::string_view line : absl::StrSplit(csv, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> cells = absl::StrSplit(line, ',');
    if (names.empty()) {
      names = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), names.size()) << line;
    auto& row = rows.emplace_back();
    for (size_t i = 0; i < std::min(cells.size(), names.size()); ++i) row[names[i]] = cells[i];
  }
  return rows;
}

double NumberOf(const std::string& text) {
  double value = std::nan("");
  EXPECT_TRUE(absl::SimpleAtod(text, &value)) << text;
  return value;
}

TEST(FitCsv, HasEveryFigureOfEveryLight) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    const ProcessResult result = RunLightfit({"fit",
                                              kYard,
                                              "--lights",
                                              kYardLights,
                                              "--csv",
                                              folder.Path(absl::StrCat(name, ".csv")),
                                              "--json",
                                              folder.Path("fit.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  const std::string csv = ReadFile(folder.Path("a.csv"));
  EXPECT_EQ(csv, ReadFile(folder.Path("b.csv")));
  const v1::FitResult fit = ReadResult(folder.Path("fit.json"));
  const auto rows = RowsOf(csv);
  ASSERT_EQ(rows.size(), static_cast<size_t>(fit.lights_size()));
  for (int i = 0; i < fit.lights_size(); ++i) {
    const v1::LightResult& light = fit.lights(i);
    auto row = rows[i];
    EXPECT_EQ(row["light"], light.name());
    EXPECT_EQ(row["status"], "ok");
    EXPECT_EQ(row["border"], "lit");
    EXPECT_EQ(row["maps"], "1");
    EXPECT_EQ(row["texels"], "1048576");
    EXPECT_EQ(NumberOf(row["final_wrong_share"]), light.foretold_wrong().final());
    EXPECT_EQ(NumberOf(row["focused_wrong_share"]), light.foretold_wrong().focused());
    EXPECT_EQ(NumberOf(row["published_wrong_share"]), light.foretold_wrong().as_published());
    // The JSON file has the fit's own sums; tables and this are summed once more.
    constexpr double kSums = 1e-9;  // relative
    const auto expect_near = [&](const char* name, double expected) {
      EXPECT_NEAR(NumberOf(row[name]) / expected, 1.0, kSums) << name;
    };
    expect_near("final_energy", light.energies().final());
    expect_near("final_footprint_rms_px", light.footprint().rms());
    expect_near("final_footprint_p99_px", light.footprint().p99());
    expect_near("final_footprint_worst_px", light.footprint().worst());
    EXPECT_EQ(row["edge_pixels_used"], absl::StrCat(light.samples().used()));
    EXPECT_EQ(row["one_map_energy"], "");
  }
  EXPECT_EQ(rows[0].at("kind"), "sun");
  EXPECT_EQ(rows[1].at("kind"), "point");
  EXPECT_NEAR(NumberOf(rows[1].at("x")), 8.946166, 1e-6);
}

TEST(FitCsv, HasPlansBesideTheSingleMap) {
  const TemporaryFolder folder;
  const ProcessResult result = RunLightfit({"fit",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--only",
                                            "key",
                                            "--maps",
                                            "3",
                                            "--texels",
                                            "400x400",
                                            "--csv",
                                            folder.Path("plan.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  auto rows = RowsOf(ReadFile(folder.Path("plan.csv")));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0]["maps"], "3");
  EXPECT_LE(NumberOf(rows[0]["texels"]), 160000.0);
  EXPECT_LT(NumberOf(rows[0]["final_energy"]), NumberOf(rows[0]["one_map_energy"]));
  EXPECT_GT(NumberOf(rows[0]["published_energy"]), NumberOf(rows[0]["one_map_energy"]));
}

// Its row stands there all the same, with the reason.
TEST(FitCsv, SaysWhyALightFailed) {
  const TemporaryFolder folder;
  const ProcessResult result = RunLightfit({"fit",
                                            kYard,
                                            "--lights",
                                            kYardLights,
                                            "--light",
                                            "moon=sun:0,0,-1",
                                            "--csv",
                                            folder.Path("fit.csv"),
                                            "--footprint",
                                            folder.Path("fit.exr")});
  ASSERT_EQ(result.exit_code, 3) << result.err;
  const std::string csv = ReadFile(folder.Path("fit.csv"));
  const std::vector<std::string> lines = absl::StrSplit(csv, '\n', absl::SkipEmpty());
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(lines[4], HasSubstr("moon,sun,0,0,-1,failed,,,"));
  EXPECT_THAT(lines[4], HasSubstr("shadow.moon"));
  EXPECT_EQ(ReadExrPixels(folder.Path("fit.exr")).channels.count("footprint.moon"), 0U);
}

TEST(FitCsv, IsNotForSummaries) {
  for (const char* flag : {"--csv", "--footprint"}) {
    const ProcessResult result = RunLightfit({"fit", "--summary", "a.summary", flag, "out"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(absl::StrCat(flag, ": needs the pixels of a read-back")));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

}  // namespace
}  // namespace lightfit
