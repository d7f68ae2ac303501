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

v1::PlanTrackerSettings PlanTrackerSettingsToProto(const PlanTrackerOptions& options) {
  v1::PlanTrackerSettings proto;
  proto.set_tolerance(options.tolerance);
  proto.set_update_every_frames(options.update_every_frames);
  proto.set_cover_margin_percent(options.cover_margin_percent);
  return proto;
}

absl::StatusOr<PlanTrackerOptions> PlanTrackerSettingsFromProto(
    const v1::PlanTrackerSettings& proto) {
  PlanTrackerOptions options;
  options.tolerance = proto.tolerance();
  options.update_every_frames = proto.update_every_frames();
  options.cover_margin_percent = proto.cover_margin_percent();
  if (absl::Status status = ValidatePlanTrackerOptions(options); !status.ok()) return status;
  return options;
}

v1::TrackedPlanState TrackedPlanStateToProto(const TrackedPlanState& state) {
  v1::TrackedPlanState proto;
  proto.set_light(state.light.name);
  proto.set_border(BorderToProto(state.border));
  proto.set_frames_since_update(state.frames_since_update);
  for (const TrackedPlanState::Map& map : state.maps) {
    v1::TrackedPlanMap& added = *proto.add_maps();
    *added.mutable_map_from_world() = MatrixToProto(map.map_from_world);
    added.set_width(map.size.width);
    added.set_height(map.size.height);
    added.set_frames_kept(map.frames_kept);
  }
  return proto;
}

absl::StatusOr<std::vector<TrackedPlanState>> TrackedPlanStatesFromProto(
    const v1::ShotInfo& shot, absl::Span<const Light> lights) {
  std::vector<TrackedPlanState> states;
  for (const v1::TrackedPlanState& proto : shot.plan_tracker_state()) {
    for (const Light& light : lights) {
      if (light.name != proto.light()) continue;
      TrackedPlanState state;
      state.light = light;
      const absl::StatusOr<Border> border =
          BorderFromProto(proto.border(), "planTrackerState.border");
      if (!border.ok()) return border.status();
      state.border = *border;
      state.frames_since_update = proto.frames_since_update();
      for (const v1::TrackedPlanMap& map : proto.maps()) {
        const absl::StatusOr<Eigen::Matrix4d> map_from_world =
            MatrixFromProto(map.map_from_world(), "planTrackerState.maps.mapFromWorld");
        if (!map_from_world.ok()) return map_from_world.status();
        const MapSize size = {map.width(), map.height()};
        if (absl::Status status = ValidateMapSize(size); !status.ok()) return status;
        state.maps.push_back({*map_from_world, size, map.frames_kept()});
      }
      states.push_back(std::move(state));
    }
  }
  return states;
}

v1::TrackedPlanChange TrackedPlanChangeToProto(const TrackedPlan& tracked) {
  v1::TrackedPlanChange proto;
  proto.set_is_new(tracked.is_new);
  for (size_t k = 0; k < tracked.actions.size(); ++k) {
    v1::TrackedMapChange& map = *proto.add_maps();
    map.set_action(TrackerActionToProto(tracked.actions[k]));
    map.set_frames_kept(tracked.frames_kept[k]);
  }
  return proto;
}

}  // namespace lightfit
