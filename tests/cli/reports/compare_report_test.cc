// Tables of comparisons made by hand.
#include "cli/reports/compare_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/reports/compare_csv.h"
#include "tests/jobs/compare/compared_lights.h"

namespace lightfit::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

CompareHeading Heading() {
  CompareHeading heading;
  heading.source = "scene.glb";
  heading.screen_width = heading.screen_height = 750;
  heading.maps = "map 400 x 400 texels";
  return heading;
}

constexpr bool kWithLegend = true;

// One line otherwise: nobody reads ten of them every time.
TEST(CompareReport, HasALegendWhereItIsAskedFor) {
  const std::string text = CompareReportText(Heading(), ThreeLights(), false);
  EXPECT_THAT(text,
              ::testing::EndsWith("\n\nColumns: lightfit compare --help, or --legend here.\n"));
  const std::string explained = CompareReportText(Heading(), ThreeLights(), false, kWithLegend);
  EXPECT_THAT(explained, Not(HasSubstr("Columns: ")));
  EXPECT_THAT(explained, HasSubstr("\n\nWrong pixels: where the shadow map says other"));
}

// The whole of it, for --help: whatever columns there may be.
TEST(CompareReport, LegendNamesEveryColumn) {
  for (const char* words : {"Wrong pixels: ",
                            "x lightfit: ",
                            "Outside: ",
                            "Means of phases: ",
                            "Foretold: ",
                            "Energy: ",
                            "Footprint: ",
                            "Maps, texels: ",
                            "Crawl, ",
                            "Flips: ",
                            "Ratio: ",
                            "Mean: ",
                            "Better: ",
                            "Failed: ",
                            "Dark: "}) {
    EXPECT_THAT(CompareLegend(), HasSubstr(words));
  }
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
  const std::string totals = CompareReportText(Heading(), lights, false, kWithLegend);
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
  lights[0].rows[0].crawl = crawl;
  CompareHeading heading = Heading();
  heading.next = "frame 7 of cameras.json";
  const std::string text = CompareReportText(heading, lights, false, kWithLegend);
  EXPECT_THAT(text, HasSubstr("crawl: to the next frame, frame 7 of cameras.json\n"));
  EXPECT_THAT(text, HasSubstr(" texels  pixels  % flips\n"));
  EXPECT_THAT(text, HasSubstr("   0.250       -     1.50\n"));  // no edge in view
  EXPECT_THAT(text, HasSubstr("       -       -        -\n"));  // lightfit has none
  EXPECT_THAT(text, HasSubstr("Flips: "));

  lights.push_back(lights[0]);
  lights[0].rows[1].crawl = lights[1].rows[1].crawl = crawl;
  EXPECT_THAT(CompareReportText(heading, lights, false), HasSubstr("   0.250       -     1.50"));

  heading.screen_width = 0;
  const std::string readback = CompareReportText(heading, lights, false);
  EXPECT_THAT(readback, HasSubstr(" texels  pixels"));
  EXPECT_THAT(readback, Not(HasSubstr("lips")));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",0.25,0,0,200,3,4,"));
}

TEST(CompareReport, SaysThatCountsAreMeans) {
  CompareHeading heading = Heading();
  EXPECT_THAT(CompareReportText(heading, ThreeLights(), false), Not(HasSubstr("mean of")));
  heading.phases = 4;
  const std::string text = CompareReportText(heading, ThreeLights(), false, kWithLegend);
  EXPECT_THAT(text, HasSubstr("map 400 x 400 texels, mean of 4 phases\n"));
  EXPECT_THAT(text, HasSubstr("\nMeans of phases: of the map moved by parts of a texel"));
  heading.screen_width = 0;  // a read-back alone has no counts
  EXPECT_THAT(CompareReportText(heading, ThreeLights(), false), Not(HasSubstr("phases")));
}

TEST(CompareReport, ShowsBordersWhereAnyIsDark) {
  std::vector<LightComparison> lights = ThreeLights();
  EXPECT_THAT(CompareReportText(Heading(), lights, true), Not(HasSubstr("dark")));
  std::get<Plan>(lights[0].rows[1].drawn.maps).border = Border::kDark;
  const std::string one = CompareReportText(Heading(), {lights[0]}, false);
  EXPECT_THAT(one, HasSubstr("method    border "));
  EXPECT_THAT(one, HasSubstr("focused      lit "));
  EXPECT_THAT(one, HasSubstr("lightfit    dark "));
  EXPECT_THAT(one, HasSubstr("Border: "));
  EXPECT_THAT(one, Not(HasSubstr("Dark: ")));
  const std::string totals = CompareReportText(Heading(), lights, false, kWithLegend);
  EXPECT_THAT(totals, HasSubstr("counted  failed  dark\n"));
  EXPECT_THAT(totals, HasSubstr("        2       1     0\n"));  // focused
  EXPECT_THAT(totals, HasSubstr("        3       0     1\n"));  // lightfit
  EXPECT_THAT(totals, HasSubstr("Dark: "));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",dark,\n"));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",lit,\n"));
}

TEST(CompareReport, PlansHaveColumnsOfTheirOwn) {
  std::vector<LightComparison> lights = {OneLight(
      "a", {Row("ZP4", 30, 40, 8), FailedRow("cube", "no way"), Row("lightfit", 10, 20, 2)})};
  auto& plan = std::get<Plan>(lights[0].rows[0].drawn.maps);
  plan.maps.resize(4);
  for (PlanMap& map : plan.maps) map.size = {20, 10};
  EXPECT_THAT(CompareReportText(Heading(), lights, false), Not(HasSubstr("texels  ")));
  CompareHeading heading = Heading();
  heading.has_plans = true;
  heading.maps = "up to 4 maps for each light, 800 texels in all";
  const std::string text = CompareReportText(heading, lights, false, kWithLegend);
  EXPECT_THAT(text, HasSubstr("; up to 4 maps for each light, 800 texels in all\n"));
  EXPECT_THAT(text, HasSubstr("maps  texels "));
  EXPECT_THAT(text, HasSubstr("ZP4          4     800 "));
  EXPECT_THAT(text, HasSubstr("cube        no maps, see below"));
  EXPECT_THAT(text, HasSubstr("\nMaps, texels: "));
  lights.push_back(lights[0]);
  lights[1].rows[0].drawn = SchemeMaps{ParaboloidPair()};
  EXPECT_THAT(CompareReportText(heading, lights, false), HasSubstr("ZP4         3.00 "));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",4,800,lit,\n"));
  EXPECT_THAT(CompareCsv(lights), HasSubstr(",,,,no way\n"));
}

}  // namespace
}  // namespace lightfit::cli
