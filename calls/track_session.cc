#include "calls/track_session.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "calls/checked_readback.h"
#include "calls/finished_result.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "calls/request_plans.h"
#include "wire/plan_shot_proto.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

constexpr double kDefaultStability = 0.5;

absl::StatusOr<double> StabilityOf(const v1::TrackSetup& setup) {
  const double stability = setup.has_stability() ? setup.stability() : kDefaultStability;
  if (stability >= 0.0 && stability <= 1.0) return stability;
  return absl::InvalidArgumentError(absl::StrFormat("stability = %g, want 0 ... 1", stability));
}

absl::StatusOr<TrackerOptions> TrackerOptionsOf(const v1::TrackSetup& setup) {
  if (setup.has_tracker()) return TrackerSettingsFromProto(setup.tracker());
  const absl::StatusOr<double> stability = StabilityOf(setup);
  if (!stability.ok()) return stability.status();
  return TrackerOptions::ForStability(*stability);
}

absl::StatusOr<PlanTrackerOptions> PlanTrackerOptionsOf(const v1::TrackSetup& setup) {
  if (setup.has_plan_tracker()) return PlanTrackerSettingsFromProto(setup.plan_tracker());
  const absl::StatusOr<double> stability = StabilityOf(setup);
  if (!stability.ok()) return stability.status();
  return PlanTrackerOptions::ForStability(*stability);
}

absl::Status CheckRule(const v1::TrackSetup& setup) {
  if (setup.has_plan_options() && setup.has_tracker()) {
    return absl::InvalidArgumentError(
        "tracker: is for one map of each light; with plan_options want stability or plan_tracker");
  }
  if (!setup.has_plan_options() && setup.has_plan_tracker()) {
    return absl::InvalidArgumentError(
        "plan_tracker: is for plans; want plan_options as well, or stability or tracker");
  }
  if (setup.state_size() <= kMaxLights) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("state: of %d lights, want at most %d", setup.state_size(), kMaxLights));
}

v1::ShotLight ShotLightOf(const TrackedMatrix& tracked) {
  v1::ShotLight shot;
  shot.set_action(TrackerActionToProto(tracked.action));
  shot.set_frames_kept(tracked.frames_kept);
  return shot;
}

v1::ShotInfo ShotOf(int64_t number, const Tracker& tracker) {
  v1::ShotInfo shot;
  shot.set_mode(v1::SHOT_MODE_TRACKED);
  shot.set_number(number);
  *shot.mutable_tracker() = TrackerSettingsToProto(tracker.options());
  for (const TrackedState& state : tracker.state()) {
    *shot.add_tracker_state() = TrackedStateToProto(state);
  }
  return shot;
}

v1::ShotInfo ShotOf(int64_t number, const PlanTrackers& plans) {
  v1::ShotInfo shot;
  shot.set_mode(v1::SHOT_MODE_TRACKED);
  shot.set_number(number);
  *shot.mutable_plan_tracker() = PlanTrackerSettingsToProto(plans.options());
  for (v1::TrackedState& state : plans.State()) *shot.add_tracker_state() = std::move(state);
  return shot;
}

void SetStatus(const absl::Status& status, v1::Status* proto) {
  proto->set_code(static_cast<int>(status.code()));
  proto->set_message(std::string(status.message()));
}

}  // namespace

absl::StatusOr<TrackSession> TrackSession::Begin(const v1::TrackSetup& setup,
                                                 const CallLimits& limits) {
  const absl::StatusOr<FitOptions> fit = OptionsOfRequest(setup.options());
  if (!fit.ok()) return fit.status();
  const absl::StatusOr<std::optional<PlanOptions>> plan = PlanOptionsOfRequest(setup, *fit, limits);
  if (!plan.ok()) return plan.status();
  if (absl::Status status = CheckRule(setup); !status.ok()) return status;
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(setup);
  if (!clip.ok()) return clip.status();
  if (plan->has_value()) {
    absl::StatusOr<PlanTrackerOptions> options = PlanTrackerOptionsOf(setup);
    if (!options.ok()) return options.status();
    options->plan = **plan;
    TrackSession session(*fit, *clip);
    session.plans_.emplace(*options);
    if (absl::Status status = session.plans_->SetState(setup.state()); !status.ok()) return status;
    return session;
  }
  absl::StatusOr<TrackerOptions> options = TrackerOptionsOf(setup);
  if (!options.ok()) return options.status();
  options->fit = *fit;
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(setup.map(), *fit);
  if (!map.ok()) return map.status();
  for (int i = 0; i < setup.state_size(); ++i) {
    const absl::StatusOr<Eigen::Matrix4d> matrix = MatrixFromProto(
        setup.state(i).map_from_world(), absl::StrFormat("state[%d].map_from_world", i));
    if (!matrix.ok()) return matrix.status();
  }
  TrackSession session(*fit, *clip);
  session.tracker_ = Tracker(*options);
  session.map_ = *map;
  session.given_state_ = setup.state();
  return session;
}

absl::StatusOr<TrackedFits> TrackSession::TrackMatrices(const std::vector<RequestLight>& lights,
                                                        const Readback& pixels) {
  std::vector<Light> usable;
  for (const RequestLight& light : lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  if (absl::Status status = TakeGivenState(usable); !status.ok()) return status;
  const TrackedMatrices tracked = tracker_.Update(pixels, usable, map_);
  TrackedFits frame;
  size_t next = 0;
  for (const RequestLight& light : lights) {
    const absl::StatusOr<TrackedMatrix>& matrix =
        light.status.ok() ? tracked[next++] : absl::StatusOr<TrackedMatrix>(light.status);
    LightFit& fit = frame.fits.emplace_back();
    fit.light = light.light;
    v1::ShotLight& shot = frame.shots.emplace_back();
    if (matrix.ok()) {
      fit.matrix = matrix->matrix;
      shot = ShotLightOf(*matrix);
    } else {
      fit.matrix = matrix.status();
    }
  }
  return frame;
}

absl::StatusOr<v1::FitResult> TrackSession::Track(const v1::TrackFrame& frame,
                                                  const Readback& given) {
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(frame.lights());
  if (!lights.ok()) return lights.status();
  if (absl::Status status = ValidateReadback(given); !status.ok()) return status;
  const CheckedReadback checked = CheckReadback(given, *lights, /*is_tracked=*/true);
  const Readback& pixels = checked.readback;
  if (plans_.has_value() && pixels.fine_cover != nullptr) {
    return absl::InvalidArgumentError(
        "readback.fine_cover: plans that are tracked do not look at it; leave it out, or leave out "
        "plan_options");
  }
  std::optional<PlanTrackers> plans = plans_;
  absl::StatusOr<TrackedFits> tracked =
      plans.has_value() ? plans->Update(pixels, *lights) : TrackMatrices(*lights, pixels);
  if (!tracked.ok()) return tracked.status();
  if (StopRequested()) return StoppedError();

  FitReport report;
  report.source = frame.readback().source();
  report.camera = pixels.camera;
  report.depth_kind = pixels.depth_kind;
  report.options = fit_options_;
  if (plans.has_value()) report.plan_options = plans->options().plan;
  report.map = map_;
  report.clip = clip_;
  report.lights = std::move(tracked->fits);
  absl::StatusOr<v1::FitResult> result = FinishedResult(report, *lights);
  if (!result.ok()) return result.status();
  checked.PutInto(result->mutable_readback());
  for (size_t i = 0; i < lights->size(); ++i) {
    if (!report.lights[i].matrix.ok()) continue;
    *result->mutable_lights(static_cast<int>(i))->mutable_shot() = tracked->shots[i];
  }
  *result->mutable_shot() =
      plans.has_value() ? ShotOf(frame.number(), *plans) : ShotOf(frame.number(), tracker_);
  plans_ = std::move(plans);
  return result;
}

absl::Status TrackSession::TakeGivenState(const std::vector<Light>& lights) {
  if (given_state_.empty()) return absl::OkStatus();
  v1::ShotInfo given;
  given.mutable_tracker_state()->Swap(&given_state_);
  absl::StatusOr<std::vector<TrackedState>> state = TrackedStatesFromProto(given, lights, map_);
  if (!state.ok()) return state.status();
  tracker_.set_state(*std::move(state));
  return absl::OkStatus();
}

v1::TrackResult TrackSession::Update(const v1::TrackFrame& frame,
                                     const absl::StatusOr<Readback>& pixels,
                                     const std::stop_token& stop) {
  const StopScope stop_scope(stop);
  v1::TrackResult answer;
  answer.set_number(frame.number());
  absl::StatusOr<v1::FitResult> result = pixels.ok() ? Track(frame, *pixels) : pixels.status();
  SetStatus(result.status(), answer.mutable_status());
  if (result.ok()) *answer.mutable_result() = *std::move(result);
  return answer;
}

}  // namespace lightfit
