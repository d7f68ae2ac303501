#include "cli/shot.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/flags/frame_inputs.h"
#include "cli/reports/legend.h"
#include "cli/reports/shot_report.h"
#include "cli/unusable_lights.h"
#include "jobs/shot/run.h"
#include "picture/png.h"
#include "picture/shot_page.h"
#include "picture/text.h"

namespace lightfit::cli {
namespace {

// Before the work, so that nobody waits for what is there.
void PrintResuming(const ShotContext& context) {
  const ShotJob& job = context.job;
  int num_done = 0;
  for (size_t i = 0; i < job.frames.size(); ++i) num_done += context.IsComplete(i) ? 1 : 0;
  if (num_done == 0) return;
  const bool needs_shot = job.Has(ShotMode::kPerShot) && !context.HasShot();
  std::printf("resuming: %d of %zu frames are done%s\n",
              num_done,
              job.frames.size(),
              needs_shot ? ", but for the map of the whole shot" : "");
  std::fflush(stdout);
}

bool HasAnswer(const ShotRows& rows) {
  for (const auto& frames : rows) {
    for (const std::vector<ShotRow>& frame : frames) {
      for (const ShotRow& row : frame) {
        if (row.error.empty()) return true;
      }
    }
  }
  return false;
}

Typeface FindTypeface() {
  Typeface typeface = Typeface::Find();
  if (!typeface.found()) {
    PrintWarning(
        "no typeface found, so the plot has no text; install fonts-dejavu-core or set "
        "LIGHTFIT_FONT to a .ttf file");
  }
  return typeface;
}

}  // namespace

std::function<int()> DeclareShot(CLI::App* app) {
  const auto flags = std::make_shared<ShotFlags>();
  DeclareShotFlags(app, flags.get());
  app->footer(app->get_footer() + LegendHelp(ShotLegend()));
  return [flags] { return RunShotVerb(*flags); };
}

int RunShotVerb(const ShotFlags& flags) {
  absl::Status status = ValidateTrackerOptions(TrackerOptionsOf(flags));
  if (const auto plans = PlanTrackerOptionsOf(flags); status.ok() && plans.has_value()) {
    status = ValidatePlanTrackerOptions(*plans);
  }
  if (!status.ok()) return Fail(kExitUsage, status);
  const absl::StatusOr<ShotJob> job = MakeShotJob(flags);
  if (!job.ok()) return Fail(kExitBadInput, job.status());
  status = MakeShotFolders(*job);
  if (!status.ok()) return Fail(kExitBadInput, status);

  if (flags.fit.as_published && !flags.per_frame && !flags.tracked) {
    PrintWarning(
        "--as-published: per-frame and tracked only, as the published algorithm has no form that "
        "fits one matrix to a whole shot");
  }
  for (const std::string& note : job->notes) PrintWarning(note);
  ShotContext context(*job);
  if (!job->quiet) PrintResuming(context);
  status = RunShot(&context);
  if (status.ok()) {
    status = WritePng(DrawShotPlot(*job, context.rows, FindTypeface()), context.paths.Plot());
  }
  if (!status.ok()) return Fail(kExitBadInput, status);
  if (!job->quiet) {
    std::fputs(ShotReportText(context, flags.fit.legend).c_str(), stdout);
    std::fflush(stdout);
  }
  for (const std::string& note : context.notes) PrintWarning(note);
  const std::vector<std::string> errors = ShotErrors(context);
  for (const std::string& error : errors) PrintError(error);
  const absl::StatusOr<std::vector<ListedLight>> lights = ListLightsOfAnyFrame(flags.fit);
  const int num_unusable = lights.ok() ? PrintUnusable(*lights, "matrix") : 0;
  if (errors.empty() && num_unusable == 0) return kExitOk;
  return HasAnswer(context.rows) ? kExitIncomplete : kExitBadInput;
}

}  // namespace lightfit::cli
