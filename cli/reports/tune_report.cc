#include "cli/reports/tune_report.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/reports/legend.h"
#include "jobs/compare/totals.h"

namespace lightfit::cli {
namespace {

std::string RatioText(int64_t fit, int64_t limit) {
  const std::optional<double> ratio = RatioOf(static_cast<double>(fit), static_cast<double>(limit));
  return ratio.has_value() ? absl::StrCat(FigureText(*ratio), "x") : "-";
}

std::string ShareText(const std::optional<double>& share) {
  return share.has_value() ? PercentText(*share) : "-";
}

}  // namespace

std::string TuneLegend() {
  return absl::StrFormat(
      "Wrong pixels: where the shadow map says other than the truth; means over %d positions of "
      "the\nmap's texels, which are what the search minimised. At other phases: over %d positions "
      "that it\nhas not seen. Limit: the best map that the search found from the fit on; it is "
      "what "
      "is written.\nForetold: wrong pixels that the read-back alone lets expect, of all pixels of "
      "the image.\n",
      kTunePhases,
      kCheckPhases);
}

std::string TuneReportText(const CompareHeading& heading,
                           const TuneOptions& options,
                           absl::Span<const TunedLight> lights,
                           bool has_legend) {
  std::string text = absl::StrFormat(
      "%s: screen %d x %d pixels, read-back %d x %d pixels; %s; %s bias\nfit: "
      "%s\n\n",
      heading.source,
      heading.screen_width,
      heading.screen_height,
      heading.readback_width,
      heading.readback_height,
      heading.maps,
      options.bias == Bias::kIdeal ? "ideal" : "practical",
      heading.fit);
  Table table;
  table.AddColumn("", "light");
  for (const char* group : {"wrong pixels", "at other phases"}) {
    for (const char* name : {"fit", "limit", "fit / limit"}) table.AddColumn(group, name);
  }
  table.AddColumn("foretold, % wrong", "fit");
  table.AddColumn("foretold, % wrong", "limit");
  table.AddColumn("maps", "tried");
  for (const TunedLight& light : lights) {
    if (!light.status.ok()) {
      table.AddRow({light.light.name, "no matrix, see below"});
      continue;
    }
    table.AddRow({light.light.name,
                  absl::StrCat(light.fit.wrong),
                  absl::StrCat(light.tuned.wrong),
                  RatioText(light.fit.wrong, light.tuned.wrong),
                  absl::StrCat(light.fit.check),
                  absl::StrCat(light.tuned.check),
                  RatioText(light.fit.check, light.tuned.check),
                  ShareText(light.fit.foretold),
                  ShareText(light.tuned.foretold),
                  absl::StrCat(light.evaluations)});
  }
  absl::StrAppend(&text, table.Text());
  const TuneTotals totals = TotalsOf(lights);
  if (totals.num_lights > 1) {
    absl::StrAppendFormat(&text,
                          "\nFit over limit, %d lights: %s in total, %s in the geometric mean; at "
                          "other phases %s and "
                          "%s.\n",
                          totals.num_lights,
                          RatioText(totals.fit_wrong, totals.tuned_wrong),
                          absl::StrCat(FigureText(totals.mean_ratio), "x"),
                          RatioText(totals.fit_check, totals.tuned_check),
                          absl::StrCat(FigureText(totals.mean_check_ratio), "x"));
  }
  absl::StrAppend(&text, LegendOrHint("tune", has_legend, TuneLegend()));
  return text;
}

}  // namespace lightfit::cli
