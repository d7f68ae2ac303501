#include "cli/reports/shot_report.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/number.h"
#include "base/table.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"
#include "cli/reports/plan_report.h"
#include "jobs/shot/totals.h"

namespace lightfit::cli {
namespace {

constexpr char kPlanLegend[] =
    "Moved: of all maps of all frames, those whose texels move over surfaces. A pixel that asks\n"
    "another map than in the frame before counts as drawn anew.\n";

constexpr char kLegend[] =
    "Energy: as a multiple of the frame's own best map, geometric mean over the frames. "
    "Updates:\n"
    "frames in which texels move over surfaces, the first among them. Phase drift: how far a\n"
    "surface moves within its texel from one frame to the next, root mean square; 0 stands still,\n"
    "0.41 is drawn anew. Edge crawl: that drift on the screen, across shadow edges. Wrong: shadow\n"
    "pixels that will be wrong, foretold, of all pixels.\n";

std::string FigureOrDash(const std::optional<double>& value) {
  return value.has_value() ? FigureText(*value) : "-";
}

std::vector<std::string> Cells(const std::string& name, const ShotTotals& totals, bool of_plans) {
  std::vector<std::string> cells = {name, absl::StrCat(totals.num_frames)};
  if (totals.num_frames == 0) {
    cells.push_back(of_plans ? "no plan, see below" : "no matrix, see below");
    return cells;
  }
  cells.push_back(absl::StrCat(totals.num_updates));
  if (of_plans) cells.push_back(absl::StrCat(totals.num_moved, " / ", totals.num_maps));
  cells.push_back(FigureOrDash(totals.energy_ratio));
  cells.push_back(FigureOrDash(totals.phase_drift_texels));
  cells.push_back(FigureOrDash(totals.edge_crawl_px));
  cells.push_back(totals.wrong_share ? PercentText(*totals.wrong_share) : "-");
  return cells;
}

Table TotalsTable(const ShotContext& context) {
  const ShotJob& job = context.job;
  Table table;
  table.AddColumn("", "light");
  table.AddColumn("", "frames");
  table.AddColumn("", "updates");
  if (job.plans.has_value()) table.AddColumn("maps", "moved / all");
  table.AddColumn("energy", "/ per-frame");
  table.AddColumn("phase drift", "texels");
  table.AddColumn("edge crawl", "pixels");
  table.AddColumn("wrong", "% of the image");
  const auto add = [&](const std::string& name, std::optional<size_t> light) {
    table.AddRow({name});
    for (const ShotMode mode : kShotModes) {
      if (!job.Has(mode)) continue;
      table.AddRow(Cells(absl::StrCat("  ", ShotModeName(mode)),
                         TotalsOf(context.rows, mode, light),
                         job.plans.has_value()));
    }
  };
  for (size_t i = 0; i < job.lights.size(); ++i) add(job.lights[i].name, i);
  if (job.lights.size() > 1) add("all lights", std::nullopt);
  return table;
}

std::string WhereText(const ShotContext& context) {
  const ShotJob& job = context.job;
  std::string text = "\nFor the renderer, clipFromWorld of every light:\n";
  if (job.Has(ShotMode::kPerFrame)) {
    absl::StrAppend(&text, "  ", job.folder, "/per-frame/FRAME.json  finest\n");
  }
  if (job.Has(ShotMode::kTracked)) {
    absl::StrAppend(&text, "  ", job.folder, "/tracked/FRAME.json  few updates\n");
  }
  if (job.Has(ShotMode::kPerShot)) {
    absl::StrAppend(&text, "  ", context.paths.Shot(), "  one for all frames\n");
  }
  absl::StrAppend(&text, "Every frame: ", context.paths.Csv(), ", ", context.paths.Plot(), "\n");
  return text;
}

std::string TrackerText(const TrackerOptions& tracker) {
  const std::string frames = tracker.update_every_frames == 1
                                 ? "every frame"
                                 : absl::StrFormat("one frame of %d", tracker.update_every_frames);
  return absl::StrFormat(
      "Tracked: the %s is kept unless the median squared footprint can fall below %s %% of what it "
      "is\nwith it, looked at in %s; a new map has %s %% more room on every side\n",
      tracker.keeps == TrackerOptions::Keeps::kAxis ? "axis" : "map",
      FigureText(100.0 * tracker.replace_below),
      frames,
      FigureText(tracker.cover_margin_percent));
}

std::string TrackerText(const PlanTrackerOptions& tracker) {
  const std::string frames = tracker.update_every_frames == 1
                                 ? "every frame"
                                 : absl::StrFormat("one frame of %d", tracker.update_every_frames);
  return absl::StrFormat(
      "Tracked: a plan is kept while its energy is at most %s %% more than that of the frame's "
      "own, "
      "looked\nat in %s; a new map has %s %% more room on every side\n",
      FigureText(100.0 * tracker.tolerance),
      frames,
      FigureText(tracker.cover_margin_percent));
}

std::string TrackerText(const ShotJob& job) {
  if (!job.Has(ShotMode::kTracked)) return "";
  return job.plans.has_value() ? TrackerText(*job.plans) : TrackerText(job.tracker);
}

// "frame 0003", "2 of 24 frames, 0003 and 0007", "9 of 24 frames, 0003 ... 0019".
std::string FramesText(const ShotJob& job, const std::vector<size_t>& frames) {
  const std::string& first = job.frames[frames.front()].name;
  if (frames.size() == 1) return absl::StrCat("frame ", first);
  const std::string& last = job.frames[frames.back()].name;
  return absl::StrFormat("%d of %d frames, %s%s%s",
                         frames.size(),
                         job.frames.size(),
                         first,
                         frames.size() == 2 ? " and " : " ... ",
                         last);
}

// Frames in which a light has no matrix in some mode, though they could be read.
struct Gap {
  std::vector<size_t> frames;
  std::string first_error;
  std::vector<std::string> modes;  // that have the very same gap
};

Gap GapOf(const ShotContext& context, ShotMode mode, size_t light) {
  Gap gap;
  const auto& rows = context.rows[static_cast<size_t>(mode)];
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!context.frame_status[i].ok() || light >= rows[i].size()) continue;
    const std::string& error = rows[i][light].error;
    if (error.empty()) continue;
    if (gap.frames.empty()) gap.first_error = error;
    gap.frames.push_back(i);
  }
  gap.modes = {ShotModeName(mode)};
  return gap;
}

std::vector<Gap> GapsOf(const ShotContext& context, size_t light) {
  std::vector<Gap> gaps;
  for (const ShotMode mode : kShotModes) {
    Gap gap = GapOf(context, mode, light);
    if (gap.frames.empty()) continue;
    const auto same = std::find_if(gaps.begin(), gaps.end(), [&gap](const Gap& other) {
      return other.frames == gap.frames && other.first_error == gap.first_error;
    });
    if (same == gaps.end()) {
      gaps.push_back(std::move(gap));
    } else {
      same->modes.push_back(gap.modes.front());
    }
  }
  return gaps;
}

std::string GapText(const ShotContext& context, size_t light, const Gap& gap) {
  const std::string name = absl::StrCat("light \"", context.job.lights[light].name, "\"");
  const bool is_named = absl::StrContains(gap.first_error, name);
  return absl::StrCat(absl::StrJoin(gap.modes, ", "),
                      context.job.plans.has_value() ? ": no plan in " : ": no matrix in ",
                      FramesText(context.job, gap.frames),
                      ": ",
                      is_named ? "" : name + ": ",
                      gap.first_error);
}

}  // namespace

std::string ShotLegend() { return absl::StrCat(kLegend, kPlanLegend); }

std::string ShotReportText(const ShotContext& context, bool has_legend) {
  const ShotJob& job = context.job;
  return absl::StrCat(
      absl::StrFormat(
          "%s: %d %s; %s\nFit: %s\n",
          job.name,
          job.frames.size(),
          job.frames.size() == 1 ? "frame" : "frames",
          MapsText(job),
          job.plans.has_value() ? PlanMethodText(job.plans->plan) : MethodText(job.fit())),
      TrackerText(job),
      "\n",
      TotalsTable(context).Text(),
      LegendOrHint(
          "shot", has_legend, absl::StrCat(kLegend, job.plans.has_value() ? kPlanLegend : "")),
      WhereText(context));
}

std::vector<std::string> ShotErrors(const ShotContext& context) {
  const ShotJob& job = context.job;
  std::vector<std::string> errors;
  for (size_t i = 0; i < job.frames.size(); ++i) {
    if (context.frame_status[i].ok()) continue;
    errors.push_back(absl::StrCat(
        "frame ", job.frames[i].name, ": ", std::string(context.frame_status[i].message())));
  }
  for (size_t light = 0; light < job.lights.size(); ++light) {
    for (const Gap& gap : GapsOf(context, light)) errors.push_back(GapText(context, light, gap));
  }
  return errors;
}

}  // namespace lightfit::cli
