#include "cli/reports/plan_report.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "cli/flags/choices.h"
#include "cli/reports/fit_cells.h"

namespace lightfit::cli {
namespace {

std::string EnergyText(const absl::StatusOr<JudgedMatrix>& map) {
  return map.ok() ? FigureText(map->figures.energy) : "-";
}

}  // namespace

std::string PlanMethodText(const PlanOptions& options) {
  return absl::StrCat("maps that are parallelograms, ",
                      WordFor(MetricWords(), options.fit.metric),
                      " metric, around what is ",
                      CoverText(options.fit));
}

Table PlanTable(const std::vector<FitComparison>& comparisons) {
  Table table;
  const bool has_border = HasDarkBorder(comparisons);
  table.AddColumn("", "light");
  if (has_border) table.AddColumn("", "border");
  table.AddColumn("", "maps");
  for (const char* name : {"published", "one map", "plan"}) {
    table.AddColumn("wrong, % of the image", name);
  }
  for (const char* name : {"published", "one map"}) table.AddColumn("fewer than", name);
  for (const char* name : {"published", "one map", "plan"}) table.AddColumn("energy", name);
  table.AddColumn("time", "ms");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) {
      table.AddRow({comparison.light.name, kNoPlan});
      continue;
    }
    const JudgedPlan& plan = **comparison.plan;
    std::vector<std::string> row = {comparison.light.name};
    if (has_border) row.push_back(BorderName(plan.plan.border));
    for (std::string cell : {absl::StrCat(plan.plan.maps.size()),
                             WrongText(comparison.published),
                             WrongText(comparison.final),
                             PercentText(plan.figures.wrong_share.value_or(0.0)),
                             RatioText(comparison.published, plan.figures),
                             RatioText(comparison.final, plan.figures),
                             EnergyText(comparison.published),
                             EnergyText(comparison.final),
                             FigureText(plan.figures.energy),
                             FigureText(comparison.final_time_ms)}) {
      row.push_back(std::move(cell));
    }
    table.AddRow(std::move(row));
  }
  return table;
}

Table PlanMapTable(const std::vector<FitComparison>& comparisons) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("", "map");
  table.AddColumn("texels", "width");
  table.AddColumn("texels", "height");
  table.AddColumn("shadow-edge", "pixels");
  table.AddColumn("", "energy");
  table.AddColumn("footprint, px", "rms");
  table.AddColumn("footprint, px", "99 %");
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) continue;
    const LightPlan& plan = (*comparison.plan)->plan;
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      const LightMatrix& map = plan.maps[k];
      table.AddRow({k == 0 ? comparison.light.name : "",
                    absl::StrCat(k),
                    absl::StrCat(map.map.width),
                    absl::StrCat(map.map.height),
                    absl::StrCat(map.figures.samples.used),
                    FigureText(map.figures.energy),
                    FigureText(map.figures.footprint.rms),
                    FigureText(map.figures.footprint.p99)});
    }
  }
  return table;
}

std::string PlanLegend() {
  return "Plan: of the maps that hold a pixel it asks the one with the finest texels. One map: our "
         "single\n"
         "map; published: Chong and Gortler's Algorithm 1; both of the texels that a plan may "
         "have.\n"
         "Wrong: shadow pixels that will be wrong, foretold, of all pixels of the image, with the\n"
         "nearest texel and no fault of the bias. Fewer than: how many times fewer the plan has;\n"
         "\"same\": about as many, as far as can be foretold.\n"
         "Energy: the sum of footprints at the shadow edges in the metric of the fit, each in the "
         "map that\nis asked there; edge pixels outside of all maps, which the border answers, are "
         "in none.\n"
         "Footprint: how far one texel reaches on the screen, in read-back pixels; below 1 is "
         "finer.\n"
         "Time: the plan of that light. Figures of a light with a dark border are over the edges "
         "that such\nmaps serve.\n";
}

}  // namespace lightfit::cli
