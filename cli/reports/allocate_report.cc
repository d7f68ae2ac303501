#include "cli/reports/allocate_report.h"

#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/flags/allocate_flags.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"

namespace lightfit::cli {
namespace {

constexpr char kLegend[] =
    "Footprint: how far one texel reaches on the screen at the shadow edges, in pixels of the "
    "final\nimage. Wrong: shadow pixels that will be wrong, foretold, of all pixels of the "
    "image.\n";
constexpr char kSummaryRmsLegend[] =
    "Footprint: how far one texel reaches on the screen at the shadow edges, in read-back "
    "pixels.\nIts percentiles and wrong pixels need a read-back: lightfit allocate "
    "READBACK.exr.\n";
constexpr char kSummaryLegend[] =
    "Footprints and wrong pixels need a read-back: lightfit allocate READBACK.exr.\n";
constexpr char kBudgetLegend[] =
    "Energy: what the split makes least, summed over the lights; beside it that of square maps "
    "of\nequal shares. Below 1 is better; a light that needs less gives way to those that need "
    "more.\n";

constexpr char kPlanBudgetLegend[] =
    "Energy: what the division makes least, summed over the lights; beside it that of plans of "
    "equal\n"
    "shares. Below 1 is better; a light that needs less gives way to those that need more.\n";

// Of the light's matrix or plan.
const Figures& FiguresOf(const LightFit& fit) {
  return fit.plan.has_value() ? fit.plan->figures : fit.matrix->figures;
}

std::string EnergyText(const LightFit& fit, const AllocationEntry& entry) {
  if (!entry.equal_split_energy || !(*entry.equal_split_energy > 0.0)) return "-";
  return FigureText(FiguresOf(fit).energy / *entry.equal_split_energy);
}

// Summaries know the root mean square alone, and only of squares.
bool HasRms(const FitOptions& options) {
  return options.compute_statistics || options.metric == Metric::kL2;
}

Table AllocationTable(const AllocationReport& report, double image_scale) {
  const bool has_budget = report.budget_texels.has_value();
  const bool has_rms = HasRms(report.fit.options);
  const bool has_samples = report.fit.options.compute_statistics;
  Table table;
  table.AddColumn("", "light");
  const bool of_plans = report.fit.plan_options.has_value();
  if (of_plans) {
    table.AddColumn("", "maps");
  } else {
    table.AddColumn("map", "width");
    table.AddColumn("map", "height");
  }
  table.AddColumn("texels, %", has_budget ? "of budget" : "of all");
  if (has_rms) table.AddColumn("footprint, pixels", "rms");
  if (has_samples) table.AddColumn("footprint, pixels", "99 %");
  if (has_samples) table.AddColumn("footprint, pixels", "worst");
  if (has_budget) table.AddColumn("energy /", "equal split");
  if (!has_budget) table.AddColumn("", "tolerance");
  if (has_samples) table.AddColumn("wrong, %", "of image");
  for (size_t i = 0; i < report.fit.lights.size(); ++i) {
    const LightFit& fit = report.fit.lights[i];
    const AllocationEntry& entry = report.entries[i];
    if (!fit.matrix.ok()) {
      table.AddRow({fit.light.name, "no map, see below"});
      continue;
    }
    const FootprintStatistics& footprint = FiguresOf(fit).footprint;
    const bool is_met = entry.reached.has_value() && entry.reached->is_met;
    std::vector<std::string> row = {fit.light.name};
    if (of_plans) {
      row.push_back(absl::StrCat(fit.plan->plan.maps.size()));
    } else {
      row.push_back(absl::StrCat(fit.matrix->map.width));
      row.push_back(absl::StrCat(fit.matrix->map.height));
    }
    row.push_back(PercentText(report.Share(i)));
    if (has_rms) row.push_back(FigureText(image_scale * footprint.rms));
    if (has_samples) row.push_back(FigureText(image_scale * footprint.p99));
    if (has_samples) row.push_back(FigureText(image_scale * footprint.worst));
    row.push_back(has_budget ? EnergyText(fit, entry) : (is_met ? "kept" : "missed"));
    if (has_samples) row.push_back(fit.wrong_share ? PercentText(*fit.wrong_share) : "-");
    table.AddRow(std::move(row));
  }
  return table;
}

// The sum over the lights, the weights in it, beside that of an equal split.
std::string TotalText(const AllocationReport& report) {
  double energy = 0.0, equal = 0.0;
  for (size_t i = 0; i < report.entries.size(); ++i) {
    const AllocationEntry& entry = report.entries[i];
    if (!report.fit.lights[i].matrix.ok() || !entry.equal_split_energy) continue;
    energy += entry.weight * FiguresOf(report.fit.lights[i]).energy;
    equal += entry.weight * *entry.equal_split_energy;
  }
  if (!(equal > 0.0)) return "";
  return absl::StrCat(
      "\nAll lights, weighted: energy ", FigureText(energy / equal), " of an equal split's.\n");
}

std::string GuaranteeText(const AllocationReport& report) {
  int64_t num_samples = 0;
  for (const AllocationEntry& entry : report.entries) {
    if (entry.reached && entry.reached->is_met) num_samples += entry.reached->num_samples;
  }
  if (num_samples == 0) return "";
  return absl::StrCat("\nGuaranteed, where kept, for the ",
                      num_samples,
                      report.fit.options.compute_statistics
                          ? " shadow-edge pixels of this read-back, each measured; not between "
                            "them.\n"
                          : " shadow-edge pixels of all frames taken\ntogether; not for each "
                            "frame, nor between those pixels.\n");
}

const char* BudgetLegend(const AllocationReport& report) {
  if (!report.budget_texels.has_value()) return "";
  return report.fit.plan_options.has_value() ? kPlanBudgetLegend : kBudgetLegend;
}

const char* Legend(const FitOptions& options) {
  if (options.compute_statistics) return kLegend;
  return HasRms(options) ? kSummaryRmsLegend : kSummaryLegend;
}

}  // namespace

std::string AllocationLegend() { return absl::StrCat(kLegend, kBudgetLegend); }

std::string AllocationText(const AllocationReport& report,
                           const std::string& source,
                           double image_scale,
                           bool has_legend) {
  const bool has_budget = report.budget_texels.has_value();
  const int64_t texels = report.Texels();
  const double square = std::floor(std::sqrt(static_cast<double>(texels)));
  const std::string goal =
      has_budget
          ? absl::StrFormat("budget of %d texels, %s %% spent",
                            *report.budget_texels,
                            FigureText(100.0 * texels / static_cast<double>(*report.budget_texels)))
          : absl::StrFormat("%s: %d texels, as many as %.0f x %.0f",
                            ToleranceText(*report.tolerance),
                            texels,
                            square,
                            square);
  return absl::StrCat(
      source,
      "\n",
      goal,
      "\nFinal: ",
      MethodText(report.fit.options),
      "\n\n",
      AllocationTable(report, image_scale).Text(),
      has_budget ? TotalText(report) : GuaranteeText(report),
      LegendOrHint(
          "allocate", has_legend, absl::StrCat(Legend(report.fit.options), BudgetLegend(report))));
}

}  // namespace lightfit::cli
