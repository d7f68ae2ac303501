// From the rows of a shot to its totals, its CSV and its plot.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_split.h"
#include "base/csv.h"
#include "jobs/shot/csv.h"
#include "jobs/shot/totals.h"
#include "picture/line_chart.h"
#include "picture/shot_page.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

// Three frames of one light; the tracked map has twice, half and three times the energy, moves in
// the first and last frame, and the second frame has no per-frame map.
class ThreeFrames : public ::testing::Test {
 protected:
  ThreeFrames() {
    job_.name = "walk";
    job_.lights = {Light::Directional("sun, \"low\"", -Eigen::Vector3d::UnitZ())};
    job_.modes = {true, true, false};
    for (int i = 0; i < 3; ++i) {
      ShotFrame& frame = job_.frames.emplace_back();
      frame.path = "walk.exr";
      frame.name = "walk";
      frame.number = FrameNumber::Whole(10 + i);
      ShotRow row;
      row.frame = i;
      row.energy = 4.0;
      row.footprint = {1.5, 1.0, 3.0, 4.0};
      row.wrong_share = 0.001 * (i + 1);
      if (i > 0) row.crawl = Crawl{100, 0.4, 0.9, 10, 0.2 * i};
      if (i == 1) row.error = "no edge, none";
      rows_[0].push_back({row});
      row.mode = ShotMode::kTracked;
      row.error.clear();
      row.action = i == 1 ? "kept" : "replaced";
      row.num_moved = i != 1 ? 1 : 0;
      row.energy = i == 0 ? 8.0 : i == 1 ? 2.0 : 12.0;
      if (i == 1) row.crawl = Crawl{100, 0.0, 0.0, 0, 0.0};
      rows_[1].push_back({row});
    }
    rows_[2].resize(3);
  }

  ShotJob job_;
  ShotRows rows_;
};

TEST_F(ThreeFrames, TotalsAreMeansOfTheFramesThatHaveThem) {
  const ShotTotals best = TotalsOf(rows_, ShotMode::kPerFrame, 0);
  EXPECT_EQ(best.num_frames, 2);
  EXPECT_EQ(best.num_failed, 1);
  EXPECT_DOUBLE_EQ(*best.energy_ratio, 1.0);
  EXPECT_DOUBLE_EQ(*best.edge_crawl_px, 0.4);
  EXPECT_DOUBLE_EQ(*best.wrong_share, 0.002);
  const ShotTotals tracked = TotalsOf(rows_, ShotMode::kTracked);
  EXPECT_EQ(tracked.num_frames, 3);
  EXPECT_EQ(tracked.num_updates, 2);
  EXPECT_DOUBLE_EQ(*tracked.energy_ratio, std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(*tracked.phase_drift_texels, 0.2);
  EXPECT_DOUBLE_EQ(*tracked.edge_crawl_px, 0.4);
  const ShotTotals none = TotalsOf(rows_, ShotMode::kPerShot);
  EXPECT_EQ(none.num_frames, 0);
  EXPECT_FALSE(none.energy_ratio.has_value());
}

TEST_F(ThreeFrames, CsvLeavesOutWhatIsNotThere) {
  const std::vector<std::string> lines = absl::StrSplit(ShotCsv(job_, rows_), '\n');
  ASSERT_EQ(lines.size(), 8u);  // names, six rows, the end
  EXPECT_THAT(lines[0], StartsWith("mode,frame,number,light,"));
  EXPECT_EQ(lines[1], "per-frame,walk,10,\"sun, \"\"low\"\"\",ok,,4,1,1.5,1,3,0.001,,,lit,,1,1");
  EXPECT_EQ(lines[2],
            "per-frame,walk,11,\"sun, \"\"low\"\"\",failed,,,,,,,,0.4,0.2,,\"no edge, none\",,");
  EXPECT_EQ(lines[5], "tracked,walk,11,\"sun, \"\"low\"\"\",ok,kept,2,,1.5,1,3,0.002,0,,lit,,1,0");
}

TEST_F(ThreeFrames, PlotHasTheColoursOfItsModes) {
  const Image plot = DrawShotPlot(job_, rows_, Typeface()).ToImage();
  const auto count = [&plot](Rgb color) {
    int num_pixels = 0;
    for (const Rgb& pixel : plot.pixels()) {
      num_pixels += pixel.r == color.r && pixel.g == color.g && pixel.b == color.b ? 1 : 0;
    }
    return num_pixels;
  };
  EXPECT_GT(count(kReceiverColor), 100);
  EXPECT_GT(count(kGainColor), 100);
  EXPECT_EQ(count(kWarningColor), 0);  // nothing per shot
}

TEST(LineChart, AxisHoldsAllValues) {
  LineChart chart;
  chart.x = {1, 2, 3};
  chart.lines = {{{2.0, std::nullopt, 5.0}, {}, {}}, {{0.5, NAN, -3.0}, {}, {}}};
  for (const bool log_y : {false, true}) {
    chart.log_y = log_y;
    const ChartAxis axis = AxisFor(chart);
    for (const double value : {0.5, 2.0, 5.0}) {
      EXPECT_GT(axis.Position(value), 0.0);
      EXPECT_LT(axis.Position(value), 1.0);
    }
    EXPECT_TRUE(log_y || axis.min < -3.0);
  }
  // One value, or none, is an axis as well.
  chart.lines = {{{0.0, 0.0, 0.0}, {}, {}}};
  EXPECT_LT(AxisFor(chart).min, AxisFor(chart).max);
  chart.log_y = false;
  EXPECT_LT(AxisFor(chart).min, AxisFor(chart).max);
}

TEST(LineChart, TicksAreRoundAndApart) {
  EXPECT_THAT(AxisTicks({-0.1, 4.3, false}, 0.2), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(AxisTicks({0.9, 2.2, true}, 0.15), ElementsAre(1, 1.2, 1.5, 2));
  EXPECT_THAT(AxisTicks({0.01, 100, true}, 0.2), ElementsAre(0.01, 0.1, 1, 10, 100));
  for (const bool log : {false, true}) {
    for (const double max : {1.1e-3, 0.7, 13.0, 4.1e6}) {
      const ChartAxis axis = {1e-3, max, log};
      const std::vector<double> ticks = AxisTicks(axis, 0.12);
      for (size_t i = 1; i < ticks.size(); ++i) {
        EXPECT_GE(axis.Position(ticks[i]) - axis.Position(ticks[i - 1]), 0.12 - 1e-9);
      }
    }
  }
}

// A value between two gaps shows as a dot, on its place.
TEST(LineChart, DrawsLonelyValues) {
  LineChart chart;
  chart.x = {1, 2, 3};
  const Rgb white = {1, 1, 1};
  chart.lines = {{{std::nullopt, 1.0, std::nullopt}, {}, white}};
  Canvas canvas(400, 200, {});
  DrawLineChart(0, 0, 400, 200, chart, Typeface(), &canvas);
  const int x = (400 + kChartLabelWidth) / 2;
  const int y = static_cast<int>(
      std::lround((200 - kChartLabelHeight) * (1.0 - AxisFor(chart).Position(1.0))));
  EXPECT_GT(canvas.At(x, y).r, 0.9f);
  EXPECT_LT(canvas.At(x + 20, y).r, 0.5f);
  EXPECT_LT(canvas.At(x - 20, y).r, 0.5f);
}

TEST(Csv, QuotesWhatHasToBe) {
  EXPECT_EQ(CsvField("sun"), "sun");
  EXPECT_EQ(CsvField("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvField("say \"a\"\nb"), "\"say \"\"a\"\" b\"");
  EXPECT_EQ(CsvNumber(0.1), "0.1");
  EXPECT_EQ(CsvNumber(std::optional<double>()), "");
}

}  // namespace
}  // namespace lightfit
