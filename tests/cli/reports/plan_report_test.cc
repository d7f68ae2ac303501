// The tables of `lightfit fit --maps`, of plans made by hand.
#include "cli/reports/plan_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "cli/reports/fit_report.h"

namespace lightfit::cli {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

using Cells = std::vector<std::string>;

JudgedMatrix Judged(double wrong_share, double energy) {
  JudgedMatrix judged;
  judged.figures.wrong_share = wrong_share;
  judged.figures.energy = energy;
  return judged;
}

FitComparison Planned(const std::string& name, Border border = Border::kLit) {
  const Light light = Light::Directional(name, {0.0, 0.0, -1.0});
  JudgedPlan judged;
  judged.plan.border = border;
  for (int k = 0; k < 2; ++k) {
    LightMatrix& map = judged.plan.maps.emplace_back();
    map.map = {300 + k, 100};
    map.figures.energy = 1.0 + k;
    map.figures.footprint.rms = 0.5;
    map.figures.footprint.p99 = 2.5;
    map.figures.samples.used = 70 + k;
  }
  judged.figures.wrong_share = 0.01;
  judged.figures.energy = 3.0;
  judged.own_figures.samples = {.candidates = 200, .used = 141};
  return {light, Judged(0.08, 9.0), Judged(0.04, 8.0), Judged(0.02, 4.0), 12.0, judged};
}

// The cells of the lines that begin with a word, a light's name say.
std::vector<Cells> RowsOf(const std::string& text, const std::string& word) {
  std::vector<Cells> rows;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    if (absl::StartsWith(line, word + " ")) {
      rows.push_back(absl::StrSplit(line, ' ', absl::SkipEmpty()));
    }
  }
  return rows;
}

TEST(PlanReport, HasAPlanBesideTheSingleMaps) {
  const std::string text = PlanTable({Planned("sun")}).Text();
  EXPECT_THAT(
      RowsOf(text, "sun"),
      ElementsAre(ElementsAre(
          "sun", "2", "4.00", "2.00", "1.00", "4.00x", "2.00x", "8.00", "4.00", "3.00", "12.0")));
  EXPECT_THAT(text, Not(HasSubstr("border")));
}

TEST(PlanReport, NumbersTheMapsOfEachLight) {
  const std::string text = PlanMapTable({Planned("sun"), Planned("rim")}).Text();
  EXPECT_THAT(RowsOf(text, "rim"),
              ElementsAre(ElementsAre("rim", "0", "300", "100", "70", "1.00", "0.500", "2.50")));
  EXPECT_THAT(RowsOf(text, ""),
              Contains(ElementsAre("1", "301", "100", "71", "2.00", "0.500", "2.50")).Times(2));
}

TEST(PlanReport, HasNoFiguresOfWhatThereIsNot) {
  FitComparison lamp = Planned("lamp", Border::kDark);
  lamp.final = absl::FailedPreconditionError("surrounded");
  lamp.published = absl::FailedPreconditionError("surrounded");
  const FitComparison failed = FailedFitComparison(Light::Directional("key", {0, 0, -1}),
                                                   absl::FailedPreconditionError("no"));
  const std::string text = PlanTable({lamp, failed}).Text();
  EXPECT_THAT(RowsOf(text, "lamp"),
              ElementsAre(ElementsAre(
                  "lamp", "dark", "2", "-", "-", "1.00", "-", "-", "-", "-", "3.00", "12.0")));
  EXPECT_THAT(text, HasSubstr("no plan, see below"));
  const std::string report = PlanReportText("a.exr", Readback(), PlanOptions(), {failed});
  EXPECT_THAT(RowsOf(report, "key"), SizeIs(2));
  EXPECT_THAT(report, Not(HasSubstr("no matrix")));
}

TEST(PlanReport, SaysTheSizesAndWhatTheyAreComparedWith) {
  PlanOptions options;
  options.texels = 120000;
  Readback readback;
  readback.camera.width = readback.camera.height = 100;
  const std::string text = PlanReportText("a.exr", readback, options, {Planned("sun")});
  EXPECT_THAT(text,
              AllOf(HasSubstr("a.exr: 100 x 100 pixels; up to 4 maps for each light, 120000 "),
                    HasSubstr("both 346 x 346"),
                    Not(HasSubstr("Border: "))));
  EXPECT_THAT(PlanReportText("a.exr", readback, options, {Planned("sun", Border::kDark)}),
              HasSubstr("outside of all maps must find"));
  options.each = MapSize{64, 32};
  EXPECT_EQ(PlanSizeText(options), "up to 4 maps for each light, 64 x 32 texels each");
}

}  // namespace
}  // namespace lightfit::cli
