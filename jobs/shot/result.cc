#include "jobs/shot/result.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "io/notes/readback_notes.h"
#include "wire/crawl_proto.h"
#include "wire/plan_shot_proto.h"
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

void SetAnswer(const ShotFit& shot_fit, const ShotJob& job, LightFit* fit) {
  if (const auto* tracked = std::get_if<TrackedPlan>(&shot_fit.answer)) {
    SetPlan(tracked->plan, shot_fit.figures, job.plans->plan.guard_texels, fit);
  } else {
    fit->matrix = std::get<TrackedMatrix>(shot_fit.answer).matrix;
    fit->matrix->figures = shot_fit.figures;
    fit->wrong_share = shot_fit.figures.wrong_share;
  }
}

FitReport ReportOf(const ShotJob& job,
                   const std::vector<Light>& lights,
                   const ReadbackFile* readback,
                   absl::Span<const absl::StatusOr<ShotFit>> fits) {
  FitReport report;
  report.options = job.fit();
  if (job.plans.has_value()) report.plan_options = job.plans->plan;
  report.map = job.map;
  report.clip = job.clip;
  if (readback != nullptr) {
    report.camera = readback->camera;
    report.depth_kind = readback->depth_kind;
  }
  for (size_t light = 0; light < fits.size(); ++light) {
    LightFit fit;
    fit.light = lights[light];
    if (fits[light].ok()) {
      SetAnswer(*fits[light], job, &fit);
    } else {
      fit.matrix = fits[light].status();
    }
    report.lights.push_back(std::move(fit));
  }
  return report;
}

bool Moved(v1::TrackerAction action) {
  return action != v1::TRACKER_ACTION_KEPT && action != v1::TRACKER_ACTION_SHIFTED;
}

// Only what is tracked says what was done to it; what a shot has for all frames never moves after
// the first.
int NumMoved(ShotMode mode, size_t frame, int num_maps, const v1::ShotLight& light) {
  switch (mode) {
    case ShotMode::kPerFrame:
      return num_maps;
    case ShotMode::kTracked: {
      if (!light.has_plan()) return Moved(light.action()) ? 1 : 0;
      const auto& maps = light.plan().maps();
      return static_cast<int>(std::count_if(
          maps.begin(), maps.end(), [](const v1::ShotMap& map) { return Moved(map.action()); }));
    }
    case ShotMode::kPerShot:
      return frame == 0 ? num_maps : 0;
  }
  return num_maps;
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

// What became of a plan in one word: "new", "kept", or "2 of 4 moved".
std::string PlanActionName(const v1::ShotPlan& change, int num_moved) {
  if (change.is_new()) return "new";
  if (num_moved == 0) return "kept";
  return absl::StrCat(num_moved, " of ", change.maps_size(), " moved");
}

void SetChange(const ShotAnswer& answer, v1::ShotLight* proto) {
  if (const auto* tracked = std::get_if<TrackedPlan>(&answer)) {
    *proto->mutable_plan() = ShotPlanToProto(*tracked);
    return;
  }
  const auto& matrix = std::get<TrackedMatrix>(answer);
  proto->set_action(TrackerActionToProto(matrix.action));
  proto->set_frames_kept(matrix.frames_kept);
}

}  // namespace

v1::FitResult ShotResultToProto(const ShotJob& job,
                                ShotMode mode,
                                size_t frame,
                                const std::string& key,
                                const ReadbackFile* readback,
                                absl::Span<const absl::StatusOr<ShotFit>> fits,
                                const ShotStates& states) {
  FitReport report = ReportOf(job, job.LightsIn(frame), readback, fits);
  report.source = job.frames[frame].path;
  v1::FitResult result = FitResultToProto(report);
  if (readback == nullptr) {
    result.mutable_readback()->clear_camera();
  } else {
    PutNotes(*readback, result.mutable_readback());
  }
  for (size_t light = 0; light < fits.size(); ++light) {
    if (!fits[light].ok()) continue;
    v1::ShotLight& proto = *result.mutable_lights(static_cast<int>(light))->mutable_shot();
    if (mode == ShotMode::kTracked) SetChange(fits[light]->answer, &proto);
    if (fits[light]->crawl) *proto.mutable_crawl() = CrawlToProto(*fits[light]->crawl);
  }
  v1::ShotInfo& shot = *result.mutable_shot();
  shot.set_mode(ModeToProto(mode));
  shot.set_frame(job.frames[frame].name);
  shot.set_number(job.frames[frame].number.floor());
  shot.set_sub_frame(static_cast<double>(job.frames[frame].number.rest()) / FrameNumber::kUnit);
  if (readback != nullptr) shot.set_key(key);
  if (mode == ShotMode::kTracked) {
    if (job.plans.has_value()) {
      *shot.mutable_plan_tracker() = PlanTrackerSettingsToProto(*job.plans);
    } else {
      *shot.mutable_tracker() = TrackerSettingsToProto(job.tracker);
    }
    for (const TrackedState& state : states.matrices) {
      *shot.add_tracker_state() = TrackedStateToProto(state);
    }
    for (const TrackedPlanState& state : states.plans) {
      *shot.add_tracker_state() = TrackedPlanStateToProto(state);
    }
  }
  return result;
}

absl::StatusOr<ShotStates> StatesOf(const ShotJob& job, const v1::FitResult& result) {
  ShotStates states;
  if (!job.plans.has_value()) {
    absl::StatusOr<std::vector<TrackedState>> matrices =
        TrackedStatesFromProto(result.shot(), job.lights, job.map);
    if (!matrices.ok()) return matrices.status();
    states.matrices = *std::move(matrices);
    return states;
  }
  for (const v1::TrackedState& proto : result.shot().tracker_state()) {
    if (!proto.has_plan()) continue;  // it had none yet
    const auto light = std::find_if(job.lights.begin(), job.lights.end(), [&](const Light& other) {
      return other.name == proto.light();
    });
    if (light == job.lights.end()) continue;
    absl::StatusOr<TrackedPlanState> state = TrackedPlanStateFromProto(proto, "trackerState");
    if (!state.ok()) return state.status();
    state->light = *light;
    states.plans.push_back(*std::move(state));
  }
  return states;
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
      row.num_maps = std::max(1, proto.plan().maps_size());
      row.num_moved = NumMoved(mode, frame, row.num_maps, proto.shot());
      if (mode == ShotMode::kTracked) {
        row.action = proto.shot().has_plan() ? PlanActionName(proto.shot().plan(), row.num_moved)
                                             : ActionName(proto.shot().action());
      }
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
