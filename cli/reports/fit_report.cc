#include "cli/reports/fit_report.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/flags/choices.h"

namespace lightfit::cli {
namespace {

constexpr char kNoMatrix[] = "no matrix, see below";

constexpr char kLegend[] =
    "\nWrong: shadow pixels that will be wrong, foretold, of all pixels of the image, with the\n"
    "nearest texel and no fault of the bias. Fewer than: how many times fewer the final map has.\n"
    "Footprint: how far one texel reaches on the screen at the shadow edges, in read-back pixels;\n"
    "below 1 is finer. Figures are over the shadow-edge pixels that a fit takes by default, "
    "whatever\n"
    "this one took; the table below counts those it took. Time: the final fit of that light.\n"
    "Focused: the usual map around all that is visible. Published: Chong and Gortler's Algorithm "
    "1.\n";

std::string RatioText(const absl::StatusOr<JudgedMatrix>& before, const Figures& after) {
  if (!before.ok() || !(after.wrong_share.value_or(0.0) > 0.0)) return "-";
  return absl::StrCat(FigureText(before->figures.wrong_share.value_or(0.0) / *after.wrong_share),
                      "x");
}

std::string WrongText(const absl::StatusOr<JudgedMatrix>& map) {
  return map.ok() ? PercentText(map->figures.wrong_share.value_or(0.0)) : "-";
}

Table FigureTable(const std::vector<FitComparison>& comparisons) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("wrong, % of the image", "focused");
  table.AddColumn("wrong, % of the image", "published");
  table.AddColumn("wrong, % of the image", "final");
  table.AddColumn("fewer than", "focused");
  table.AddColumn("fewer than", "published");
  table.AddColumn("rms footprint", "focused");
  table.AddColumn("rms footprint", "final");
  table.AddColumn("99 % footprint", "focused");
  table.AddColumn("99 % footprint", "final");
  table.AddColumn("time", "ms");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.final.ok()) {
      table.AddRow({comparison.light.name, kNoMatrix});
      continue;
    }
    const Figures& final = comparison.final->figures;
    const bool has_focused = comparison.focused.ok();
    table.AddRow({comparison.light.name,
                  WrongText(comparison.focused),
                  WrongText(comparison.published),
                  WrongText(comparison.final),
                  RatioText(comparison.focused, final),
                  RatioText(comparison.published, final),
                  has_focused ? FigureText(comparison.focused->figures.footprint.rms) : "-",
                  FigureText(final.footprint.rms),
                  has_focused ? FigureText(comparison.focused->figures.footprint.p99) : "-",
                  FigureText(final.footprint.p99),
                  FigureText(comparison.final_time_ms)});
  }
  return table;
}

Table SampleTable(const std::vector<FitComparison>& comparisons) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("shadow-edge pixels", "found");
  table.AddColumn("shadow-edge pixels", "used");
  table.AddColumn("rejected", "depth edge");
  table.AddColumn("rejected", "facing away");
  table.AddColumn("rejected", "edge-on");
  table.AddColumn("rejected", "background");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.final.ok()) {
      table.AddRow({comparison.light.name, kNoMatrix});
      continue;
    }
    const SampleCounts& counts = comparison.final->matrix.figures.samples;
    table.AddRow({comparison.light.name,
                  absl::StrCat(counts.candidates),
                  absl::StrCat(counts.used),
                  absl::StrCat(counts.discontinuity),
                  absl::StrCat(counts.facing_away),
                  absl::StrCat(counts.edge_on),
                  absl::StrCat(counts.background)});
  }
  return table;
}

}  // namespace

std::string MethodText(const FitOptions& options) {
  return absl::StrCat(WordFor(SearchWords(), options.search),
                      " search",
                      options.ray_space == RaySpace::kLightSpace ? " in light space" : "",
                      ", ",
                      WordFor(AffineWords(), options.affine),
                      ", ",
                      WordFor(MetricWords(), options.metric),
                      " metric, around what is ",
                      options.cover == Cover::kShadowed ? "shadowed" : "visible");
}

std::string ShortMethodText(const FitOptions& options) {
  return absl::StrCat(
      WordFor(SearchWords(), options.search), " search, ", WordFor(MetricWords(), options.metric));
}

std::string FitReportText(const std::string& source,
                          const Readback& readback,
                          MapSize map,
                          const FitOptions& options,
                          const std::vector<FitComparison>& comparisons) {
  return absl::StrCat(absl::StrFormat("%s: %d x %d pixels; map %d x %d texels\nFinal: %s\n\n",
                                      source,
                                      readback.width(),
                                      readback.height(),
                                      map.width,
                                      map.height,
                                      MethodText(options)),
                      FigureTable(comparisons).Text(),
                      "\n",
                      SampleTable(comparisons).Text(),
                      kLegend);
}

}  // namespace lightfit::cli
