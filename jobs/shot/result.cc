#include "jobs/shot/result.h"

#include <utility>

#include "wire/crawl_proto.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

v1::ShotMode ModeToProto(ShotMode mode) {
  switch (mode) {
    case ShotMode::kPerFrame:
      return v1::SHOT_MODE_PER_FRAME;
    case ShotMode::kTracked:
      return v1::SHOT_MODE_TRACKED;
    case ShotMode::kPerShot:
      return v1::SHOT_MODE_PER_SHOT;
  }
  return v1::SHOT_MODE_UNSPECIFIED;
}

FitReport ReportOf(const ShotJob& job,
                   const ReadbackFile* readback,
                   absl::Span<const absl::StatusOr<ShotFit>> fits) {
  FitReport report;
  report.options = job.fit();
  report.map = job.map;
  report.clip = job.clip;
  if (readback != nullptr) {
    report.camera = readback->camera;
    report.depth_kind = readback->depth_kind;
  }
  for (size_t light = 0; light < fits.size(); ++light) {
    LightFit fit;
    fit.light = job.lights[light];
    if (fits[light].ok()) {
      fit.matrix = fits[light]->tracked.matrix;
      fit.wrong_share = fit.matrix->figures.wrong_share;
    } else {
      fit.matrix = fits[light].status();
    }
    report.lights.push_back(std::move(fit));
  }
  return report;
}

// Only a tracked matrix says what was done to it; that of a shot never moves after its first frame.
bool Moved(ShotMode mode, size_t frame, v1::TrackerAction action) {
  switch (mode) {
    case ShotMode::kPerFrame:
      return true;
    case ShotMode::kTracked:
      return action != v1::TRACKER_ACTION_KEPT && action != v1::TRACKER_ACTION_SHIFTED;
    case ShotMode::kPerShot:
      return frame == 0;
  }
  return true;
}

// TrackerActionName() of the message.
std::string ActionName(v1::TrackerAction action) {
  for (const TrackerAction known : {TrackerAction::kFirst,
                                    TrackerAction::kKept,
                                    TrackerAction::kShifted,
                                    TrackerAction::kRelaid,
                                    TrackerAction::kReplaced,
                                    TrackerAction::kInvalid}) {
    if (TrackerActionToProto(known) == action) return TrackerActionName(known);
  }
  return "";
}

}  // namespace

v1::FitResult ShotResultToProto(const ShotJob& job,
                                ShotMode mode,
                                size_t frame,
                                const std::string& key,
                                const ReadbackFile* readback,
                                absl::Span<const absl::StatusOr<ShotFit>> fits,
                                absl::Span<const TrackedState> states) {
  FitReport report = ReportOf(job, readback, fits);
  report.source = job.frames[frame].path;
  v1::FitResult result = FitResultToProto(report);
  if (readback == nullptr) result.mutable_readback()->clear_camera();
  for (size_t light = 0; light < fits.size(); ++light) {
    if (!fits[light].ok()) continue;
    v1::ShotLight& proto = *result.mutable_lights(static_cast<int>(light))->mutable_shot();
    if (mode == ShotMode::kTracked) {
      proto.set_action(TrackerActionToProto(fits[light]->tracked.action));
      proto.set_frames_kept(fits[light]->tracked.frames_kept);
    }
    if (fits[light]->crawl) *proto.mutable_crawl() = CrawlToProto(*fits[light]->crawl);
  }
  v1::ShotInfo& shot = *result.mutable_shot();
  shot.set_mode(ModeToProto(mode));
  shot.set_frame(job.frames[frame].name);
  shot.set_number(job.frames[frame].number);
  if (readback != nullptr) shot.set_key(key);
  if (mode == ShotMode::kTracked) {
    *shot.mutable_tracker() = TrackerSettingsToProto(job.tracker);
    for (const TrackedState& state : states) *shot.add_tracker_state() = TrackedStateToProto(state);
  }
  return result;
}

std::vector<ShotRow> RowsOfResult(const ShotJob& job,
                                  ShotMode mode,
                                  size_t frame,
                                  const v1::FitResult& result) {
  std::vector<ShotRow> rows;
  for (size_t light = 0; light < job.lights.size(); ++light) {
    ShotRow row;
    row.mode = mode;
    row.frame = frame;
    row.light = light;
    row.error = "the result is not there";
    if (static_cast<int>(light) < result.lights_size()) {
      const v1::LightResult& proto = result.lights(static_cast<int>(light));
      row.error = proto.status().message();
      row.moved = Moved(mode, frame, proto.shot().action());
      if (mode == ShotMode::kTracked) row.action = ActionName(proto.shot().action());
      row.border = proto.border() == v1::BORDER_DARK ? Border::kDark : Border::kLit;
      row.energy = proto.energies().final();
      row.footprint = {proto.footprint().rms(),
                       proto.footprint().median(),
                       proto.footprint().p99(),
                       proto.footprint().worst()};
      row.wrong_share = proto.foretold_wrong().final();
      if (proto.shot().has_crawl()) row.crawl = CrawlFromProto(proto.shot().crawl());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lightfit
