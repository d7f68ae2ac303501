#include "wire/shot_proto.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "wire/matrix_proto.h"

namespace lightfit {

v1::TrackerSettings TrackerSettingsToProto(const TrackerOptions& options) {
  v1::TrackerSettings proto;
  proto.set_keeps(options.keeps == TrackerOptions::Keeps::kAxis ? v1::TRACKER_KEEPS_AXIS
                                                                : v1::TRACKER_KEEPS_MATRIX);
  proto.set_replace_below(options.replace_below);
  proto.set_update_every_frames(options.update_every_frames);
  proto.set_cover_margin_percent(options.cover_margin_percent);
  proto.set_hard_validity(options.hard_validity);
  return proto;
}

absl::StatusOr<TrackerOptions> TrackerSettingsFromProto(const v1::TrackerSettings& proto) {
  TrackerOptions options;
  switch (proto.keeps()) {
    case v1::TRACKER_KEEPS_MATRIX:
      options.keeps = TrackerOptions::Keeps::kMatrix;
      break;
    case v1::TRACKER_KEEPS_AXIS:
      options.keeps = TrackerOptions::Keeps::kAxis;
      break;
    default:
      return absl::InvalidArgumentError(absl::StrFormat(
          "tracker.keeps = %d, want TRACKER_KEEPS_MATRIX or TRACKER_KEEPS_AXIS", proto.keeps()));
  }
  if (!std::isfinite(proto.replace_below())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("tracker.replace_below = %g, want a number", proto.replace_below()));
  }
  options.replace_below = proto.replace_below();
  options.update_every_frames = proto.update_every_frames();
  options.cover_margin_percent = proto.cover_margin_percent();
  options.hard_validity = proto.hard_validity();
  if (absl::Status status = ValidateTrackerOptions(options); !status.ok()) return status;
  return options;
}

v1::TrackerAction TrackerActionToProto(TrackerAction action) {
  switch (action) {
    case TrackerAction::kFirst:
      return v1::TRACKER_ACTION_FIRST;
    case TrackerAction::kKept:
      return v1::TRACKER_ACTION_KEPT;
    case TrackerAction::kShifted:
      return v1::TRACKER_ACTION_SHIFTED;
    case TrackerAction::kRelaid:
      return v1::TRACKER_ACTION_RELAID;
    case TrackerAction::kReplaced:
      return v1::TRACKER_ACTION_REPLACED;
    case TrackerAction::kInvalid:
      return v1::TRACKER_ACTION_INVALID;
  }
  return v1::TRACKER_ACTION_UNSPECIFIED;
}

v1::TrackedState TrackedStateToProto(const TrackedState& state) {
  v1::TrackedState proto;
  proto.set_light(state.light.name);
  *proto.mutable_map_from_world() = MatrixToProto(state.map_from_world);
  proto.set_frames_kept(state.frames_kept);
  proto.set_frames_since_update(state.frames_since_update);
  proto.set_border(BorderToProto(state.border));
  return proto;
}

absl::StatusOr<std::vector<TrackedState>> TrackedStatesFromProto(const v1::ShotInfo& shot,
                                                                 absl::Span<const Light> lights,
                                                                 MapSize map) {
  std::vector<TrackedState> states;
  for (const v1::TrackedState& proto : shot.tracker_state()) {
    for (const Light& light : lights) {
      if (light.name != proto.light()) continue;
      const absl::StatusOr<Eigen::Matrix4d> map_from_world =
          MatrixFromProto(proto.map_from_world(), "trackerState.mapFromWorld");
      if (!map_from_world.ok()) return map_from_world.status();
      const absl::StatusOr<Border> border = BorderFromProto(proto.border(), "trackerState.border");
      if (!border.ok()) return border.status();
      states.push_back(
          {light, map, *border, *map_from_world, proto.frames_kept(), proto.frames_since_update()});
    }
  }
  return states;
}

}  // namespace lightfit
