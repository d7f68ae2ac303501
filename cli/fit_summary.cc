#include "cli/fit_summary.h"

#include <chrono>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/output_file.h"
#include "base/table.h"
#include "cli/exit_code.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"
#include "cli/summary_inputs.h"
#include "jobs/fit_summary.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

struct SummaryFit {
  const LightSummary* light = nullptr;
  absl::StatusOr<LightMatrix> matrix = absl::UnknownError("not fitted");
  double time_ms = 0;
};

const char* EnergyMeaning(Metric metric) {
  switch (metric) {
    case Metric::kL2:
      return "the sum over the samples of squared footprints, (read-back pixels per texel)^2";
    case Metric::kL2AcrossEdge:
      return "the sum over the samples of squared footprints across the shadow edge, (read-back "
             "pixels per texel)^2";
    case Metric::kL1:
      return "a bound on the sum over the samples of footprints, read-back pixels per texel";
    case Metric::kL1AcrossEdge:
      return "a bound on the sum over the samples of footprints across the shadow edge, read-back "
             "pixels per texel";
  }
  return "";
}

std::string ReportText(const std::string& source,
                       MapSize map,
                       const FitOptions& options,
                       const std::vector<SummaryFit>& fits,
                       bool has_legend) {
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("frames", "in");
  table.AddColumn("frames", "without");
  table.AddColumn("shadow-edge pixels", "found");
  table.AddColumn("shadow-edge pixels", "used");
  table.AddColumn("energy", "start");
  table.AddColumn("energy", "final");
  table.AddColumn("energy", "final / start");
  table.AddColumn("time", "ms");
  for (const SummaryFit& fit : fits) {
    if (!fit.matrix.ok()) {
      table.AddRow({fit.light->name(), "no matrix, see below"});
      continue;
    }
    const LightMatrix& matrix = *fit.matrix;
    table.AddRow({fit.light->name(),
                  absl::StrCat(fit.light->total.num_frames),
                  absl::StrCat(fit.light->num_frames_without),
                  absl::StrCat(matrix.figures.samples.candidates),
                  absl::StrCat(matrix.figures.samples.used),
                  FigureText(matrix.search.energy_start),
                  FigureText(matrix.figures.energy),
                  matrix.search.energy_start > 0.0
                      ? FigureText(matrix.figures.energy / matrix.search.energy_start)
                      : "-",
                  FigureText(fit.time_ms)});
  }
  const std::string legend = absl::StrCat(
      "Energy: ",
      EnergyMeaning(options.metric),
      ";\nstart: that of the map the search began with. Wrong pixels, percentiles and other "
      "methods\nneed a read-back: lightfit fit READBACK.exr.\n");
  return absl::StrFormat("%s: %d frames; map %d x %d texels\nFinal: %s\n\n%s%s",
                         source,
                         fits.front().light->num_frames(),
                         map.width,
                         map.height,
                         MethodText(options),
                         table.Text(),
                         LegendOrHint("fit", has_legend, legend));
}

absl::Status WriteJson(const FitFlags& flags,
                       const FitOptions& options,
                       const std::vector<SummaryFit>& fits) {
  FitReport report;
  report.source = SourceText(flags.summary_paths);
  report.options = options;
  report.map = flags.map;
  report.clip = flags.clip;
  for (const SummaryFit& fit : fits) {
    LightFit& light = report.lights.emplace_back();
    light.light = fit.light->total.light;
    light.matrix = fit.matrix;
  }
  v1::FitResult result = FitResultToProto(report);
  ClearReadbackFigures(result.mutable_readback(), result.mutable_lights());
  return WriteFitResultJson(flags.json_path, result);
}

}  // namespace

int RunFitSummary(const FitFlags& flags) {
  if (!flags.json_path.empty()) {
    absl::Status status = CheckWritable("--json", flags.json_path);
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  const absl::StatusOr<SummarySet> sum = ReadSummaries(flags.summary_paths, flags.only);
  if (!sum.ok()) return Fail(kExitBadInput, sum.status());
  const absl::StatusOr<FitOptions> options = OptionsFor(flags, sum->options);
  if (!options.ok()) return Fail(kExitBadInput, options.status());

  std::vector<SummaryFit> fits;
  for (const LightSummary& light : sum->lights) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    SummaryFit& fit = fits.emplace_back();
    fit.light = &light;
    fit.matrix = FitSummary(light, flags.map, *options);
    fit.time_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  if (!flags.quiet) {
    const std::string title = TitleText(flags.summary_paths);
    std::fputs(ReportText(title, flags.map, *options, fits, flags.legend).c_str(), stdout);
    std::fflush(stdout);
  }
  int num_failed = 0;
  for (const SummaryFit& fit : fits) {
    if (!fit.matrix.ok()) {
      ++num_failed;
      PrintError(absl::StrCat("no matrix for ", fit.matrix.status().message()));
      continue;
    }
    if (fit.light->num_frames_without > 0) PrintWarning(MissingFramesText(*fit.light));
    const std::string text = FocusedInsteadText(*fit.matrix, *options);
    if (!text.empty()) PrintWarning(text);
  }
  if (!flags.json_path.empty()) {
    absl::Status status = WriteJson(flags, *options, fits);
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  return CodeFor(num_failed, static_cast<int>(fits.size()));
}

}  // namespace lightfit::cli
