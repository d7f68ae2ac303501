#include "calls/track_session.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "calls/finished_result.h"
#include "calls/request_fields.h"
#include "calls/request_lights.h"
#include "calls/request_options.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

constexpr double kDefaultStability = 0.5;

absl::StatusOr<TrackerOptions> TrackerOptionsOf(const v1::TrackSetup& setup) {
  absl::StatusOr<TrackerOptions> options;
  if (setup.has_tracker()) {
    options = TrackerSettingsFromProto(setup.tracker());
    if (!options.ok()) return options.status();
  } else {
    const double stability = setup.has_stability() ? setup.stability() : kDefaultStability;
    if (!(stability >= 0.0 && stability <= 1.0)) {
      return absl::InvalidArgumentError(absl::StrFormat("stability = %g, want 0 ... 1", stability));
    }
    options = TrackerOptions::ForStability(stability);
  }
  const absl::StatusOr<FitOptions> fit = OptionsOfRequest(setup.options());
  if (!fit.ok()) return fit.status();
  options->fit = *fit;
  return options;
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

void SetStatus(const absl::Status& status, v1::Status* proto) {
  proto->set_code(static_cast<int>(status.code()));
  proto->set_message(std::string(status.message()));
}

}  // namespace

absl::StatusOr<TrackSession> TrackSession::Begin(const v1::TrackSetup& setup) {
  const absl::StatusOr<TrackerOptions> options = TrackerOptionsOf(setup);
  if (!options.ok()) return options.status();
  const absl::StatusOr<MapSize> map = MapSizeOfRequest(setup.map(), options->fit);
  if (!map.ok()) return map.status();
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(setup);
  if (!clip.ok()) return clip.status();
  if (setup.state_size() > kMaxLights) {
    return absl::InvalidArgumentError(
        absl::StrFormat("state: of %d lights, want at most %d", setup.state_size(), kMaxLights));
  }
  for (int i = 0; i < setup.state_size(); ++i) {
    const absl::StatusOr<Eigen::Matrix4d> matrix = MatrixFromProto(
        setup.state(i).map_from_world(), absl::StrFormat("state[%d].map_from_world", i));
    if (!matrix.ok()) return matrix.status();
  }
  TrackSession session(*options, *map, *clip);
  session.given_state_ = setup.state();
  return session;
}

absl::StatusOr<v1::FitResult> TrackSession::Track(const v1::TrackFrame& frame,
                                                  const Readback& pixels) {
  const absl::StatusOr<std::vector<RequestLight>> lights = LightsOfRequest(frame.lights());
  if (!lights.ok()) return lights.status();
  if (absl::Status status = ValidateReadback(pixels); !status.ok()) return status;
  std::vector<Light> usable;
  for (const RequestLight& light : *lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  if (absl::Status status = TakeGivenState(usable); !status.ok()) return status;
  const TrackedMatrices tracked = tracker_.Update(pixels, usable, map_);
  if (StopRequested()) return StoppedError();

  FitReport report;
  report.source = frame.readback().source();
  report.camera = pixels.camera;
  report.depth_kind = pixels.depth_kind;
  report.options = tracker_.options().fit;
  report.map = map_;
  report.clip = clip_;
  std::vector<v1::ShotLight> shots;
  size_t next = 0;
  for (const RequestLight& light : *lights) {
    const absl::StatusOr<TrackedMatrix>& matrix =
        light.status.ok() ? tracked[next++] : absl::StatusOr<TrackedMatrix>(light.status);
    LightFit& fit = report.lights.emplace_back();
    fit.light = light.light;
    v1::ShotLight& shot = shots.emplace_back();
    if (matrix.ok()) {
      fit.matrix = matrix->matrix;
      shot = ShotLightOf(*matrix);
    } else {
      fit.matrix = matrix.status();
    }
  }
  absl::StatusOr<v1::FitResult> result = FinishedResult(report, *lights);
  if (!result.ok()) return result.status();
  for (size_t i = 0; i < shots.size(); ++i) {
    if (!report.lights[i].matrix.ok()) continue;
    *result->mutable_lights(static_cast<int>(i))->mutable_shot() = shots[i];
  }
  *result->mutable_shot() = ShotOf(frame.number(), tracker_);
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
