// The tables of `lightfit fit`, of fits made by hand.
#include "cli/reports/fit_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "base/number.h"
#include "tests/testing/random_cases.h"

namespace lightfit::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Random;

JudgedMatrix Judged(double wrong_share, Border border = Border::kLit) {
  JudgedMatrix judged;
  judged.matrix.border = border;
  judged.matrix.figures.samples = {.receivers = 9000,
                                   .candidates = 100,
                                   .background = 1,
                                   .discontinuity = 2,
                                   .facing_away = 3,
                                   .edge_on = 4,
                                   .used = 73,
                                   .beyond_map = 17};
  judged.figures.wrong_share = wrong_share;
  judged.figures.footprint.rms = 2.0;
  judged.figures.footprint.p99 = 5.0;
  return judged;
}

FitComparison Fitted(const std::string& name,
                     double focused,
                     double published,
                     double final,
                     Border border = Border::kLit,
                     int shadow_bit = 0) {
  return {Light::Directional(name, {0.0, 0.0, -1.0}, shadow_bit),
          Judged(focused),
          Judged(published),
          Judged(final, border),
          /*final_time_ms=*/7.0};
}

// A read-back of that many pixels along each side; the report looks at no other of its fields.
struct Square {
  Readback readback;
  std::vector<uint32_t> facing;

  explicit Square(int side, uint32_t facing_lights = 0) : facing(static_cast<size_t>(side) * side) {
    readback.camera.width = readback.camera.height = side;
    if (facing_lights != 0) readback.facing_bits = facing;
    readback.facing_lights = facing_lights;
  }
};

std::string Report(const std::vector<FitComparison>& comparisons,
                   const Square& square = Square(180)) {
  FitOptions options;
  options.border = BorderChoice::kAutomatic;
  return FitReportText("a.exr", square.readback, {1024, 1024}, options, comparisons);
}

using Cells = std::vector<std::string>;

// The cells of the lines of the two tables that begin with a word, a light's name say.
std::vector<Cells> RowsOf(const std::string& report, const std::string& light) {
  std::vector<Cells> rows;
  for (const absl::string_view line : absl::StrSplit(report, '\n')) {
    if (absl::StartsWith(line, light + " ")) {
      rows.push_back(absl::StrSplit(line, ' ', absl::SkipEmpty()));
    }
  }
  return rows;
}

TEST(FitReport, HasNoColumnsOfBordersWhereAllAreLit) {
  const std::string report =
      Report({Fitted("sun", 0.03, 0.02, 0.01), Fitted("rim", 0.3, 0.2, 0.1)});
  const std::vector<Cells> headings = RowsOf(report, "light");
  ASSERT_EQ(headings.size(), 2u);
  EXPECT_EQ(headings[0][1], "focused");
  EXPECT_EQ(headings[1].back(), "background");
  EXPECT_THAT(report, Not(HasSubstr("Border: ")));
  const std::vector<Cells> rows = RowsOf(report, "sun");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_THAT(
      rows[0],
      ElementsAre(
          "sun", "3.00", "2.00", "1.00", "3.00x", "2.00x", "2.00", "2.00", "5.00", "5.00", "7.00"));
  EXPECT_THAT(rows[1], ElementsAre("sun", "100", "73", "2", "3", "4", "1"));
}

TEST(FitReport, ShowsBordersAndWhatLiesFarOutsideWhereAnyIsDark) {
  const std::string report = Report({Fitted("sun", 0.03, 0.02, 0.01, Border::kDark),
                                     Fitted("rim", 0.3, 0.2, 0.1),
                                     FailedFitComparison(Light::Directional("key", {0, 0, -1}),
                                                         absl::FailedPreconditionError("no"))});
  const std::vector<Cells> headings = RowsOf(report, "light");
  ASSERT_EQ(headings.size(), 2u);
  EXPECT_EQ(headings[0][1], "border");
  EXPECT_EQ(headings[1].back(), "outside");
  EXPECT_THAT(report, HasSubstr("  far outside\n"));
  EXPECT_THAT(report, HasSubstr("\nBorder: what look-ups outside the final map must find"));
  const std::vector<Cells> sun = RowsOf(report, "sun"), rim = RowsOf(report, "rim");
  ASSERT_EQ(sun.size(), 2u);
  ASSERT_EQ(rim.size(), 2u);
  EXPECT_EQ(sun[0].size(), 12u);
  EXPECT_EQ(rim[0].size(), 12u);
  EXPECT_EQ(sun[0][1], "dark");
  EXPECT_EQ(rim[0][1], "lit");
  EXPECT_THAT(sun[1], ElementsAre("sun", "100", "73", "2", "3", "4", "1", "17"));
  EXPECT_EQ(rim[1].back(), "17");
  const std::vector<Cells> key = RowsOf(report, "key");
  ASSERT_EQ(key.size(), 2u);
  for (const Cells& row : key) {
    EXPECT_THAT(row, ElementsAre("key", "no", "matrix,", "see", "below"));
  }
}

// By what the final map has, not by who it is compared with, nor by a light without a map.
TEST(FitReport, ABorderThatOnlyAnotherMapHasShowsNone) {
  FitComparison comparison = Fitted("sun", 0.03, 0.02, 0.01);
  comparison.focused->matrix.border = Border::kDark;
  EXPECT_THAT(Report({comparison}), Not(HasSubstr("far outside")));
}

TEST(FitReport, HasALegendWhereItIsAskedFor) {
  const std::vector<FitComparison> comparisons = {Fitted("sun", 0.03, 0.02, 0.01)};
  const std::string text = Report(comparisons);
  EXPECT_THAT(text, HasSubstr("\n\nColumns: lightfit fit --help, or --legend here.\n"));
  EXPECT_THAT(text, Not(HasSubstr("Footprint: ")));
  const Square square(180);
  const std::string explained = FitReportText(
      "a.exr", square.readback, {1024, 1024}, FitOptions(), comparisons, /*has_legend=*/true);
  EXPECT_THAT(explained, HasSubstr("\n\n" + FitLegend()));
  EXPECT_THAT(explained, Not(HasSubstr("Columns: ")));
  for (const char* words :
       {"Wrong: ", "Fewer than: ", "Footprint: ", "Time: ", "Focused: ", "dark"}) {
    EXPECT_THAT(FitLegend(), HasSubstr(words));
  }
}

// Within a factor of kSameForecast either way, and in figures beyond.
TEST(FitReport, SaysSameWhereForecastsCannotTellMapsApart) {
  Random random(902);
  int num_same = 0, num_fewer = 0, num_more = 0;
  for (int i = 0; i < 200; ++i) {
    const double final = random.LogUniform(1e-4, 0.1);
    const double ratios[] = {random.Uniform(0.8, 1.25), random.LogUniform(0.2, 20.0)};
    const auto rows =
        RowsOf(Report({Fitted("sun", ratios[0] * final, ratios[1] * final, final)}), "sun");
    ASSERT_EQ(rows.size(), 2u);
    for (const int k : {0, 1}) {
      const double ratio = ratios[k] * final / final;
      const bool is_same = ratio < 1.1 && ratio * 1.1 > 1.0;
      EXPECT_EQ(rows[0][4 + k], is_same ? "same" : FigureText(ratio) + "x") << ratio;
      (is_same ? num_same : ratio > 1.0 ? num_fewer : num_more) += 1;
    }
  }
  EXPECT_GE(num_same, 50);
  EXPECT_GE(num_fewer, 50);
  EXPECT_GE(num_more, 50);
  // Where nothing is foretold to be wrong there is no ratio.
  EXPECT_EQ(RowsOf(Report({Fitted("sun", 0.1, 0.0, 0.0)}), "sun")[0][4], "-");
  EXPECT_EQ(RowsOf(Report({Fitted("sun", 0.0, 0.1, 0.1)}), "sun")[0][4], "0x");
}

TEST(FitReport, SaysHowGoodForecastsAreAndWhatWouldMakeThemBetter) {
  const std::vector<FitComparison> comparisons = {Fitted("sun", 0.03, 0.02, 0.01)};
  for (const auto& [side, with, without] :
       {std::tuple(180, "1.8", "2.3"), std::tuple(360, "1.8", "2.3")}) {
    const std::string begin = "On two lights of three the measured share is within a factor of ";
    const std::string known = Report(comparisons, Square(side, 1u));
    EXPECT_THAT(known, ::testing::EndsWith(begin + with + " of the foretold one.\n"));
    EXPECT_THAT(known, Not(HasSubstr("facing.LIGHT")));
    const std::string unknown = Report(comparisons, Square(side));
    EXPECT_THAT(unknown,
                ::testing::EndsWith(begin + without +
                                    " of the foretold one; with\nfacing.LIGHT channels in the "
                                    "read-back it is nearer, and borders can be chosen.\n"));
    for (const std::string& report : {known, unknown}) {
      for (const absl::string_view line : absl::StrSplit(report, '\n')) {
        EXPECT_LE(line.size(), 110u) << line;
      }
    }
  }
  // Of nobody nothing.
  const FitComparison failed = FailedFitComparison(Light::Directional("sun", {0, 0, -1}),
                                                   absl::FailedPreconditionError("no"));
  EXPECT_THAT(Report({failed}), Not(HasSubstr("On two lights")));
}

// A quarter of the pixels, of the light of which it is known.
TEST(FitReport, SaysWhatIsMeasuredWhereTheReadbackSaysWhatTheMapSays) {
  const std::vector<FitComparison> comparisons = {Fitted("sun", 0.03, 0.02, 0.01),
                                                  Fitted("rim", 0.03, 0.02, 0.01, Border::kLit, 1)};
  Square square(180);
  const std::vector<float> depth(180 * 180, 2.0f);
  const std::vector<uint32_t> dark(180 * 180);
  std::vector<uint32_t> mapped(180 * 180);
  for (size_t i = 0; i < mapped.size(); i += 4) mapped[i] = 3u;
  square.readback.depth = depth;
  square.readback.shadow_bits = dark;
  constexpr char kWords[] = "Wrong with the map that is drawn with, measured: ";
  EXPECT_THAT(Report(comparisons, square), Not(HasSubstr(kWords)));
  square.readback.mapped_bits = mapped;
  EXPECT_THAT(Report(comparisons, square),
              ::testing::EndsWith(std::string(kWords) + "sun 25.0 %, rim 25.0 %.\n"));
  square.readback.mapped_lights = 2u;
  EXPECT_THAT(Report(comparisons, square),
              ::testing::EndsWith(std::string(kWords) + "rim 25.0 %.\n"));
}

TEST(FocusedInsteadText, IsThereForTooFewSamplesAlone) {
  LightMatrix matrix;
  matrix.light_name = "sun";
  matrix.figures.samples.used = 5;
  FitOptions options;
  options.samples.min_samples = 12;
  for (const StopReason reason : {StopReason::kNoSearch,
                                  StopReason::kConverged,
                                  StopReason::kRoundLimit,
                                  StopReason::kAxisAtLimit}) {
    matrix.search.stop_reason = reason;
    EXPECT_THAT(FocusedInsteadText(matrix, options), IsEmpty());
  }
  matrix.search.stop_reason = StopReason::kTooFewSamples;
  EXPECT_EQ(FocusedInsteadText(matrix, options),
            "light \"sun\": 5 usable shadow-edge pixels, fewer than 12 (--min-samples): its matrix "
            "is the focused map");
}

}  // namespace
}  // namespace lightfit::cli
