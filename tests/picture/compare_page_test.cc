// Totals, tables and comma-separated values of hand-made comparisons, and the pieces of the
// picture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "absl/strings/str_split.h"
#include "base/progress.h"
#include "cli/reports/compare_report.h"
#include "jobs/compare/totals.h"
#include "optimizer/figures/figures.h"
#include "picture/bar_chart.h"
#include "picture/compare_choice.h"
#include "picture/shadow_panel.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

using cli::CompareCsv;
using cli::CompareHeading;
using cli::CompareReportText;
using ::testing::HasSubstr;
using ::testing::Not;

ComparedMap Row(const std::string& name, int64_t ideal, int64_t practical, double energy) {
  ComparedMap map;
  map.name = name;
  map.wrong = WrongPixels();
  map.wrong->ideal = ideal;
  map.wrong->practical = practical;
  map.figures = Figures();
  map.figures->energy = energy;
  return map;
}

ComparedMap FailedRow(const std::string& name, const std::string& reason) {
  ComparedMap map;
  map.name = name;
  map.status = absl::FailedPreconditionError(reason);
  return map;
}

LightComparison OneLight(const std::string& name, std::vector<ComparedMap> maps) {
  LightComparison light;
  light.light = Light::Directional(name, {0, -1, 0.5});
  light.maps = std::move(maps);
  return light;
}

std::vector<LightComparison> ThreeLights() {
  return {OneLight("a", {Row("focused", 30, 40, 8), Row("lightfit", 10, 20, 2)}),
          OneLight("b", {Row("focused", 5, 20, 2), Row("lightfit", 9, 20, 4)}),
          OneLight("c", {FailedRow("focused", "no, \"never\""), Row("lightfit", 100, 100, 1)})};
}

TEST(Totals, CountTheLightsThatBothHave) {
  const std::vector<MethodTotals> totals = TotalsOf(ThreeLights());
  ASSERT_EQ(totals.size(), 2u);
  const MethodTotals& focused = totals[0];
  EXPECT_EQ(focused.num_lights, 2);
  EXPECT_EQ(focused.num_failed, 1);
  EXPECT_EQ(focused.ideal->total, 35);
  EXPECT_EQ(focused.ideal->lightfit_total, 19);
  EXPECT_DOUBLE_EQ(*focused.ideal->ratio, 35.0 / 19.0);
  EXPECT_DOUBLE_EQ(focused.ideal->mean_ratio, std::sqrt((31.0 / 11.0) * (6.0 / 10.0)));
  EXPECT_EQ(focused.ideal->num_wins, 1);
  EXPECT_EQ(focused.practical->num_wins, 0);  // a draw is no win
  EXPECT_DOUBLE_EQ(*focused.mean_energy_ratio, std::sqrt((8.0 / 2.0) * (2.0 / 4.0)));
  EXPECT_EQ(totals[1].num_lights, 3);
  EXPECT_DOUBLE_EQ(*totals[1].ideal->ratio, 1.0);
}

TEST(Totals, HaveNoRatioToNothing) {
  const std::vector<LightComparison> lights = {
      OneLight("a", {Row("focused", 3, 0, 0), Row("lightfit", 0, 0, 0)}),
      OneLight("b", {FailedRow("focused", "?"), FailedRow("lightfit", "?")})};
  const std::vector<MethodTotals> totals = TotalsOf(lights);
  EXPECT_FALSE(totals[0].ideal->ratio.has_value());
  EXPECT_DOUBLE_EQ(totals[0].ideal->mean_ratio, 4.0);
  EXPECT_FALSE(totals[0].mean_energy_ratio.has_value());
  EXPECT_EQ(totals[1].num_failed, 1);
  EXPECT_TRUE(TotalsOf({}).empty());
}

CompareHeading Heading() {
  CompareHeading heading;
  heading.source = "scene.glb";
  heading.screen_width = heading.screen_height = 750;
  heading.map = {400, 400};
  return heading;
}

TEST(CompareReport, OneLightHasATableOfItsMethods) {
  const std::string text = CompareReportText(Heading(), {ThreeLights()[0]}, false);
  EXPECT_THAT(text, HasSubstr("scene.glb: screen 750 x 750 pixels"));
  EXPECT_THAT(text, HasSubstr("focused        30         40    3.00x      2.00x"));
  EXPECT_THAT(text, HasSubstr("lightfit       10         20    1.00x      1.00x"));
  EXPECT_THAT(text, Not(HasSubstr("lights\n")));
}

TEST(CompareReport, ManyLightsHaveOneTableOrMore) {
  const std::vector<LightComparison> lights = ThreeLights();
  const std::string totals = CompareReportText(Heading(), lights, false);
  EXPECT_THAT(totals, HasSubstr("3 lights"));
  EXPECT_THAT(totals, HasSubstr("geometric mean"));
  EXPECT_THAT(totals, Not(HasSubstr("never")));
  const std::string all = CompareReportText(Heading(), lights, true);
  EXPECT_THAT(all, HasSubstr("focused: no, \"never\""));
  EXPECT_THAT(all, HasSubstr("3 lights"));
}

TEST(CompareReport, SaysTheSameWordsOnce) {
  const std::vector<LightComparison> lights = {OneLight(
      "a", {FailedRow("psm", "no way"), FailedRow("tsm", "no way"), Row("lightfit", 1, 1, 1)})};
  EXPECT_THAT(CompareReportText(Heading(), lights, false), HasSubstr("\npsm, tsm: no way\n"));
}

TEST(CompareReport, CrawlHasColumnsOnlyWhereItIsMeasured) {
  std::vector<LightComparison> lights = {ThreeLights()[0]};
  EXPECT_THAT(CompareReportText(Heading(), lights, false), Not(HasSubstr("crawl")));
  MapCrawl crawl;
  crawl.points.num_points = 900;
  crawl.points.phase_drift_texels = 0.25;
  crawl.flicker = Flicker{200, 3, 4};
  lights[0].maps[0].crawl = crawl;
  CompareHeading heading = Heading();
  heading.next = "frame 7 of cameras.json";
  const std::string text = CompareReportText(heading, lights, false);
  EXPECT_THAT(text, HasSubstr("crawl: to the next frame, frame 7 of cameras.json\n"));
  EXPECT_THAT(text, HasSubstr(" texels  pixels  % flips\n"));
  EXPECT_THAT(text, HasSubstr("   0.250       -     1.50\n"));  // no edge in view
  EXPECT_THAT(text, HasSubstr("       -       -        -\n"));  // lightfit has none
  EXPECT_THAT(text, HasSubstr("Flips: "));

  lights.push_back(lights[0]);
  lights[0].maps[1].crawl = lights[1].maps[1].crawl = crawl;
  EXPECT_THAT(CompareReportText(heading, lights, false), HasSubstr("   0.250       -     1.50"));

  heading.screen_width = 0;
  const std::string readback = CompareReportText(heading, lights, false);
  EXPECT_THAT(readback, HasSubstr(" texels  pixels"));
  EXPECT_THAT(readback, Not(HasSubstr("lips")));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",0.25,0,0,200,3,4,"));
}

// Splits a line at the commas outside quotes.
std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back().push_back(c);
    }
  }
  return fields;
}

TEST(CompareCsv, HasALineForEachLightAndMethod) {
  const std::string csv = CompareCsv(ThreeLights());
  const std::vector<std::string> lines = absl::StrSplit(csv, '\n');
  ASSERT_EQ(lines.size(), 1u + 6u + 1u);
  const std::vector<std::string> names = Fields(lines[0]);
  for (size_t i = 1; i + 1 < lines.size(); ++i) {
    EXPECT_EQ(Fields(lines[i]).size(), names.size()) << lines[i];
  }
  EXPECT_EQ(lines[1].substr(0, 34), "a,sun,0,-1,0.5,focused,ok,30,40,0,");
  EXPECT_THAT(lines[5], HasSubstr("c,sun,0,-1,0.5,focused,failed,,,,,,,,,,,"));
  EXPECT_THAT(lines[5], HasSubstr("\"no, \"\"never\"\"\""));
}

TEST(DurationText, ReadsAsPeopleSayIt) {
  EXPECT_EQ(DurationText(0), "0 s");
  EXPECT_EQ(DurationText(7.2), "8 s");
  EXPECT_EQ(DurationText(59.5), "1 min 0 s");
  EXPECT_EQ(DurationText(125), "2 min 5 s");
  EXPECT_EQ(DurationText(4800), "1 h 20 min");
  EXPECT_EQ(DurationText(NAN), "0 s");
  EXPECT_EQ(DurationText(INFINITY), "1000 h 0 min");
}

TEST(BestCrop, IsTheLargestSumOfAll) {
  constexpr int kWidth = 23, kHeight = 17;
  std::mt19937 random(7);
  std::vector<int32_t> gain(kWidth * kHeight);
  for (int32_t& value : gain) value = static_cast<int32_t>(random() % 7) - 3;
  const CropBox size = {0, 0, 6, 4};
  const auto sum_of = [&](int x0, int y0) {
    int64_t sum = 0;
    for (int y = y0; y < y0 + size.height; ++y) {
      for (int x = x0; x < x0 + size.width; ++x) sum += gain[y * kWidth + x];
    }
    return sum;
  };
  const CropBox best = BestCrop(gain, kWidth, kHeight, size);
  for (int y = 0; y + size.height <= kHeight; ++y) {
    for (int x = 0; x + size.width <= kWidth; ++x) {
      EXPECT_LE(sum_of(x, y), sum_of(best.x, best.y));
    }
  }
  const CropBox whole = BestCrop(gain, kWidth, kHeight, {0, 0, kWidth, kHeight});
  EXPECT_EQ(whole.x, 0);
  EXPECT_EQ(whole.y, 0);
}

TEST(ReducedPanel, KeepsASingleWrongPixelVisible) {
  Image full(40, 40, {0.5f, 0.5f, 0.5f});
  std::vector<uint8_t> wrong(40 * 40, 0);
  full.Blend(21, 9, kFalseShadowColor);
  wrong[9 * 40 + 21] = 1;
  const Image panel = ReducedPanel(full, wrong, 4);
  ASSERT_EQ(panel.width(), 10);
  // Sixteen pixels share the square, yet it is more mark than grey.
  EXPECT_GT(panel.At(5, 2).r - panel.At(5, 2).b, 0.4f);
  EXPECT_NEAR(panel.At(4, 2).r, 0.5, 1e-6);
}

TEST(EnlargedCrop, RepeatsPixels) {
  Image full(8, 8, {});
  full.Blend(3, 2, {1, 1, 1});
  const Image crop = EnlargedCrop(full, {2, 1, 4, 3}, 5);
  EXPECT_EQ(crop.width(), 20);
  EXPECT_EQ(crop.height(), 15);
  EXPECT_EQ(crop.At(5, 5).r, 1);
  EXPECT_EQ(crop.At(9, 9).r, 1);
  EXPECT_EQ(crop.At(10, 9).r, 0);
}

TEST(BarChart, IsAsLongAsTheNumbers) {
  Canvas canvas(200, 100, {});
  DrawBarChart(0,
               0,
               200,
               100,
               {{"", 10, {1, 0, 0}}, {"", 5, {0, 1, 0}}, {"", 0, {0, 0, 1}}},
               Typeface(),
               &canvas);
  float red = 0, green = 0, blue = 0;
  const Image drawn = canvas.ToImage();
  for (const Rgb& pixel : drawn.pixels()) {
    red += pixel.r;
    green += pixel.g;
    blue += pixel.b;
  }
  EXPECT_GT(red, 100);
  EXPECT_NEAR(green / red, 0.5, 0.01);
  EXPECT_EQ(blue, 0);
}

TEST(ComparePicture, DrawsTheLightWhereMethodsDifferMost) {
  const std::vector<LightComparison> lights = ThreeLights();
  EXPECT_EQ(MostTellingLight(lights, Bias::kIdeal), 0u);
  EXPECT_EQ(MostTellingLight(absl::MakeSpan(lights).subspan(1), Bias::kPractical), 0u);
  EXPECT_EQ(MostTellingLight(absl::MakeSpan(lights).subspan(2), Bias::kIdeal), 0u);
}

}  // namespace
}  // namespace lightfit
