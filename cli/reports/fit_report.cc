#include "cli/reports/fit_report.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/flags/choices.h"
#include "cli/reports/fit_cells.h"
#include "cli/reports/legend.h"
#include "cli/reports/plan_report.h"
#include "optimizer/figures/foretell.h"

namespace lightfit::cli {
namespace {

constexpr char kLegend[] =
    "Wrong: shadow pixels that will be wrong, foretold, of all pixels of the image, with the\n"
    "nearest texel and no fault of the bias. Fewer than: how many times fewer the final map has;\n"
    "\"same\": about as many, as far as can be foretold.\n"
    "Footprint: how far one texel reaches on the screen at the shadow edges, in read-back pixels;\n"
    "below 1 is finer. Figures are over the shadow-edge pixels that a fit takes by default, "
    "whatever\n"
    "this one took; the second table counts those it took. Time: the final fit of that light.\n"
    "Focused: the usual map around all that is visible. Published: Chong and Gortler's Algorithm "
    "1.\n";

constexpr char kDarkLegend[] =
    "Figures of a light with a dark border are over the edges that such maps serve.\n";

// Whoever misses these two gets wrong shadows: they stand below the table of a light that has it,
// whether or not a legend is asked for.
constexpr char kBorderNote[] =
    "Border: what look-ups outside the final map must find; the matrix is of no use with the "
    "other.\n";

constexpr char kPlanBorderNote[] =
    "Border: what look-ups outside of all maps must find; the maps are of no use with the "
    "other.\n";

// How far off the forecasts may be, and what would make them better.
std::string ForecastText(const Readback& readback, const std::vector<FitComparison>& comparisons) {
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) continue;
    return absl::StrFormat(
        "On two lights of three the measured share is within a factor of %.1f of the foretold "
        "one%s.\n",
        ForecastFactor(readback, comparison.light),
        readback.KnowsFacing(comparison.light.shadow_bit)
            ? ""
            : "; with\nfacing.LIGHT channels in the read-back it is nearer, and borders can be "
              "chosen");
  }
  return "";
}

Table FigureTable(const std::vector<FitComparison>& comparisons) {
  Table table;
  const bool has_border = HasDarkBorder(comparisons);
  table.AddColumn("", "light");
  if (has_border) table.AddColumn("", "border");
  table.AddColumn("wrong, % of the image", "focused");
  table.AddColumn("wrong, % of the image", "published");
  table.AddColumn("wrong, % of the image", "final");
  table.AddColumn("fewer than", "focused");
  table.AddColumn("fewer than", "published");
  table.AddColumn("rms footprint, px", "focused");
  table.AddColumn("rms footprint, px", "final");
  table.AddColumn("99 % footprint, px", "focused");
  table.AddColumn("99 % footprint, px", "final");
  table.AddColumn("time", "ms");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.final.ok()) {
      table.AddRow({comparison.light.name, kNoMatrix});
      continue;
    }
    const Figures& final = comparison.final->figures;
    const bool has_focused = comparison.focused.ok();
    std::vector<std::string> row = {comparison.light.name};
    if (has_border) row.push_back(BorderName(comparison.final->matrix.border));
    for (std::string cell :
         {WrongText(comparison.focused),
          WrongText(comparison.published),
          WrongText(comparison.final),
          RatioText(comparison.focused, final),
          RatioText(comparison.published, final),
          has_focused ? FigureText(comparison.focused->figures.footprint.rms) : std::string("-"),
          FigureText(final.footprint.rms),
          has_focused ? FigureText(comparison.focused->figures.footprint.p99) : std::string("-"),
          FigureText(final.footprint.p99),
          FigureText(comparison.final_time_ms)}) {
      row.push_back(std::move(cell));
    }
    table.AddRow(std::move(row));
  }
  return table;
}

// `none` stands in the row of a light that has no answer.
Table SampleTable(const std::vector<FitComparison>& comparisons, const char* none) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("shadow-edge pixels", "found");
  table.AddColumn("shadow-edge pixels", "used");
  table.AddColumn("rejected", "depth edge");
  table.AddColumn("rejected", "facing away");
  table.AddColumn("rejected", "edge-on");
  table.AddColumn("rejected", "background");
  const bool has_border = HasDarkBorder(comparisons);
  if (has_border) table.AddColumn("rejected", "far outside");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) {
      table.AddRow({comparison.light.name, none});
      continue;
    }
    const SampleCounts& counts = comparison.samples();
    std::vector<std::string> row = {comparison.light.name,
                                    absl::StrCat(counts.candidates),
                                    absl::StrCat(counts.used),
                                    absl::StrCat(counts.discontinuity),
                                    absl::StrCat(counts.facing_away),
                                    absl::StrCat(counts.edge_on),
                                    absl::StrCat(counts.background)};
    if (has_border) row.push_back(absl::StrCat(counts.beyond_map));
    table.AddRow(std::move(row));
  }
  return table;
}

// What the read-back says of the map that was drawn with, light by light, where it does.
std::string MeasuredText(const Readback& readback, const std::vector<FitComparison>& comparisons) {
  std::string text;
  for (const FitComparison& comparison : comparisons) {
    const std::optional<double> share = MeasuredWrongShare(readback, comparison.light);
    if (!share.has_value()) continue;
    absl::StrAppend(&text,
                    text.empty() ? "Wrong with the map that is drawn with, measured: " : ", ",
                    comparison.light.name,
                    " ",
                    PercentText(*share),
                    " %");
  }
  return text.empty() ? text : absl::StrCat(text, ".\n");
}

}  // namespace

std::string FocusedInsteadText(const LightMatrix& matrix, const FitOptions& options) {
  if (matrix.search.stop_reason != StopReason::kTooFewSamples) return "";
  return absl::StrFormat(
      "light \"%s\": %d usable shadow-edge pixels, fewer than %d (--min-samples): its matrix is "
      "the "
      "focused map",
      absl::string_view(matrix.light_name),
      matrix.figures.samples.used,
      options.samples.min_samples);
}

std::string MethodText(const FitOptions& options) {
  return absl::StrCat(WordFor(SearchWords(), options.search),
                      " search",
                      options.ray_space == RaySpace::kLightSpace ? " in light space" : "",
                      ", ",
                      WordFor(AffineWords(), options.affine),
                      ", ",
                      WordFor(MetricWords(), options.metric),
                      " metric, around what is ",
                      CoverText(options));
}

std::string ShortMethodText(const FitOptions& options) {
  return absl::StrCat(
      WordFor(SearchWords(), options.search), " search, ", WordFor(MetricWords(), options.metric));
}

std::string FitLegend() { return absl::StrCat(kLegend, kDarkLegend); }

std::string FitReportText(const std::string& source,
                          const Readback& readback,
                          MapSize map,
                          const FitOptions& options,
                          const std::vector<FitComparison>& comparisons,
                          bool has_legend) {
  return absl::StrCat(absl::StrFormat("%s: %d x %d pixels; map %d x %d texels\nFinal: %s\n\n",
                                      source,
                                      readback.width(),
                                      readback.height(),
                                      map.width,
                                      map.height,
                                      MethodText(options)),
                      FigureTable(comparisons).Text(),
                      "\n",
                      SampleTable(comparisons, kNoMatrix).Text(),
                      LegendOrHint("fit", has_legend, FitLegend()),
                      HasDarkBorder(comparisons) ? kBorderNote : "",
                      ForecastText(readback, comparisons),
                      MeasuredText(readback, comparisons));
}

std::string PlanReportText(const std::string& source,
                           const Readback& readback,
                           const PlanOptions& options,
                           const std::vector<FitComparison>& comparisons,
                           bool has_legend) {
  const MapSize one = OneMapSize(options);
  return absl::StrCat(absl::StrFormat("%s: %d x %d pixels; %s\nPlans: %s\nPublished and one map: "
                                      "both %d x %d texels\n\n",
                                      source,
                                      readback.width(),
                                      readback.height(),
                                      PlanSizeText(options),
                                      PlanMethodText(options),
                                      one.width,
                                      one.height),
                      PlanTable(comparisons).Text(),
                      "\n",
                      PlanMapTable(comparisons).Text(),
                      "\n",
                      SampleTable(comparisons, kNoPlan).Text(),
                      LegendOrHint("fit", has_legend, PlanLegend()),
                      HasDarkBorder(comparisons) ? kPlanBorderNote : "",
                      ForecastText(readback, comparisons),
                      MeasuredText(readback, comparisons));
}

}  // namespace lightfit::cli
