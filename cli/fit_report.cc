#include "cli/fit_report.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/choices.h"
#include "cli/number.h"
#include "cli/table.h"

namespace lightfit {
namespace {

constexpr char kNoMatrix[] = "no matrix, see below";

constexpr char kLegend[] =
    "\nFootprint: how far one texel reaches on the screen, in read-back pixels; below 1 is finer.\n"
    "Energy: footprints (l2: squared) summed over the used shadow-edge pixels; lower is better.\n"
    "Gain: how many times lower the final energy is. Time: the final fit of that light alone.\n"
    "Focused: the usual map around all that is visible. Published: Chong and Gortler's Algorithm "
    "1.\n";

std::string RatioText(const absl::StatusOr<LightMatrix>& before, double energy_after) {
  if (!before.ok()) return "-";
  return energy_after > 0 ? absl::StrCat(FigureText(before->energy / energy_after), "x") : "-";
}

std::string EnergyText(const absl::StatusOr<LightMatrix>& matrix) {
  return matrix.ok() ? FigureText(matrix->energy) : "-";
}

Table FigureTable(const std::vector<Comparison>& comparisons) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("energy", "focused");
  table.AddColumn("energy", "published");
  table.AddColumn("energy", "final");
  table.AddColumn("gain over", "focused");
  table.AddColumn("gain over", "published");
  table.AddColumn("rms footprint", "focused");
  table.AddColumn("rms footprint", "final");
  table.AddColumn("worst footprint", "focused");
  table.AddColumn("worst footprint", "final");
  table.AddColumn("time", "ms");
  for (const Comparison& comparison : comparisons) {
    if (!comparison.final.ok()) {
      table.AddRow({comparison.light.name, kNoMatrix});
      continue;
    }
    const LightMatrix& final = *comparison.final;
    const bool has_focused = comparison.focused.ok();
    table.AddRow({comparison.light.name,
                  EnergyText(comparison.focused),
                  EnergyText(comparison.published),
                  FigureText(final.energy),
                  RatioText(comparison.focused, final.energy),
                  RatioText(comparison.published, final.energy),
                  has_focused ? FigureText(comparison.focused->footprint.rms) : "-",
                  FigureText(final.footprint.rms),
                  has_focused ? FigureText(comparison.focused->footprint.worst) : "-",
                  FigureText(final.footprint.worst),
                  FigureText(comparison.final_time_ms)});
  }
  return table;
}

Table SampleTable(const std::vector<Comparison>& comparisons) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("shadow-edge pixels", "found");
  table.AddColumn("shadow-edge pixels", "used");
  table.AddColumn("rejected", "depth edge");
  table.AddColumn("rejected", "facing away");
  table.AddColumn("rejected", "edge-on");
  table.AddColumn("rejected", "background");
  for (const Comparison& comparison : comparisons) {
    if (!comparison.final.ok()) {
      table.AddRow({comparison.light.name, kNoMatrix});
      continue;
    }
    const SampleCounts& counts = comparison.final->samples;
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
                      " metric");
}

std::string FitReportText(const std::string& source,
                          const Readback& readback,
                          MapSize map,
                          const FitOptions& options,
                          const std::vector<Comparison>& comparisons) {
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

}  // namespace lightfit
