#include "cli/allocate.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "cli/allocate_inputs.h"
#include "cli/command_line/standard_streams.h"
#include "cli/exit_code.h"
#include "cli/reports/allocate_report.h"
#include "cli/reports/legend.h"
#include "cli/summary_inputs.h"
#include "geometry/map_size.h"
#include "jobs/allocate_lights.h"
#include "jobs/fit_summary.h"
#include "partition/fit_plans.h"

namespace lightfit::cli {
namespace {

// A bar on stderr while it works.
absl::StatusOr<AllocationReport> Allocate(const AllocateFlags& flags, const AllocationTask& task) {
  const int num_lights = static_cast<int>(task.lights.size());
  int num_steps = num_lights;
  if (task.plans.has_value()) {
    num_steps = 1 + num_lights;
  } else if (task.budget_texels.has_value()) {
    num_steps = 2 * num_lights;
  }
  Progress progress(num_steps, flags.fit.quiet);
  bool has_begun = false;
  absl::StatusOr<AllocationReport> report =
      AllocateLights(task, [&progress, &has_begun](const std::string& what) {
        if (has_begun) progress.Advance();
        has_begun = true;
        progress.Begin(what);
      });
  if (!report.ok()) return report;
  report->fit.source = task.readback.has_value() ? WithStreamNames(flags.fit.readback_path)
                                                 : SourceText(flags.fit.summary_paths);
  report->fit.clip = flags.fit.clip;
  return report;
}

std::string SourceLine(const AllocateFlags& flags, const AllocateInputs& inputs) {
  if (const std::optional<SummarySet>& summaries = inputs.task.summaries) {
    const int64_t num_frames = summaries->lights.front().num_frames();
    return absl::StrFormat("%s: %d %s",
                           TitleText(flags.fit.summary_paths),
                           num_frames,
                           num_frames == 1 ? "frame" : "frames");
  }
  return absl::StrFormat("%s (%s): %d x %d pixels, final image %s times as wide",
                         WithStreamNames(flags.fit.readback_path),
                         inputs.notes.OriginText(),
                         inputs.readback->camera.width,
                         inputs.readback->camera.height,
                         FigureText(inputs.image_scale));
}

// Names on stderr the lights without a map, and those whose map misses the tolerance, with the way
// out; returns how many there are.
int PrintFailedLights(const AllocationReport& report) {
  int num_failed = 0;
  for (size_t i = 0; i < report.entries.size(); ++i) {
    const LightFit& fit = report.fit.lights[i];
    const std::string name = absl::StrCat("light \"", fit.light.name, "\"");
    const std::optional<ReachedTolerance>& reached = report.entries[i].reached;
    if (!fit.matrix.ok()) {
      PrintFailedLight("map", fit.light.name, fit.matrix.status());
      ++num_failed;
    } else if (reached.has_value() && !reached->is_met) {
      PrintError(
          absl::StrFormat("%s: %s pixels at the largest map, %d x %d; want %s: raise --max-side "
                          "(%d), or --tolerance %s can be kept",
                          name,
                          FigureText(reached->reached_px),
                          fit.matrix->map.width,
                          fit.matrix->map.height,
                          ToleranceText(*report.tolerance),
                          report.rules.max_side,
                          ToleranceThatHolds(*report.tolerance, reached->reached_px)));
      ++num_failed;
    }
  }
  return num_failed;
}

// Names on stderr the lights with a map that some frames have nothing of.
void PrintMissingFrames(const AllocationReport& report, const SummarySet& summaries) {
  for (size_t i = 0; i < summaries.lights.size(); ++i) {
    const LightSummary& light = summaries.lights[i];
    if (report.fit.lights[i].matrix.ok() && light.num_frames_without > 0) {
      PrintWarning(MissingFramesText(light));
    }
  }
}

}  // namespace

std::function<int()> DeclareAllocate(CLI::App* app) {
  const auto flags = std::make_shared<AllocateFlags>();
  DeclareAllocateFlags(app, flags.get());
  app->footer(app->get_footer() + LegendHelp(AllocationLegend()));
  return [flags] { return RunAllocate(*flags); };
}

int RunAllocate(const AllocateFlags& flags) {
  absl::Status status = ValidateFitOptions(flags.fit.options);
  if (status.ok()) status = ValidateMapSizeRules(flags.rules);
  if (!status.ok()) return Fail(kExitUsage, status);
  if (!flags.fit.json_path.empty()) {
    status = CheckWritable("--json", flags.fit.json_path);
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  const absl::StatusOr<AllocateInputs> inputs = ReadAllocateInputs(flags);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());
  if (const std::optional<PlanOptions>& plans = inputs->task.plans; plans.has_value()) {
    const auto num_lights = static_cast<int>(inputs->task.lights.size());
    status = ValidateSharedBudget(num_lights, *plans, "--budget");
    if (!status.ok()) return Fail(kExitUsage, status);
  }

  PrintWarnings(inputs->notes.Warnings());

  const absl::StatusOr<AllocationReport> report = Allocate(flags, inputs->task);
  if (!report.ok()) return Fail(kExitBadInput, report.status());
  if (!flags.fit.quiet) {
    const std::string source = SourceLine(flags, *inputs);
    const std::string text = AllocationText(*report, source, inputs->image_scale, flags.fit.legend);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  const int num_failed = PrintFailedLights(*report);
  const std::optional<SummarySet>& summaries = inputs->task.summaries;
  if (summaries.has_value()) PrintMissingFrames(*report, *summaries);
  if (!flags.fit.json_path.empty()) {
    status =
        WriteAllocationJson(flags.fit.json_path, AllocationMessage(*report, summaries.has_value()));
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  // A map that misses the tolerance is a map.
  const bool has_map = std::any_of(report->fit.lights.begin(),
                                   report->fit.lights.end(),
                                   [](const LightFit& light) { return light.matrix.ok(); });
  return has_map ? CodeFor(num_failed, num_failed + 1) : kExitBadInput;
}

}  // namespace lightfit::cli
