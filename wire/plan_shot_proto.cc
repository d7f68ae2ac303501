#include "wire/plan_shot_proto.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "partition/plan.h"
#include "wire/matrix_proto.h"
#include "wire/shot_proto.h"

namespace lightfit {

namespace {

// Frames are counted on, and never come to so many.
constexpr int64_t kMaxFrames = int64_t{1} << 53;

absl::Status CheckFrames(int64_t frames, absl::string_view field, absl::string_view name) {
  if (frames >= 0 && frames <= kMaxFrames) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s.%s = %d, want 0 or more", field, name, frames));
}

absl::StatusOr<TrackedPlanState::Map> TrackedMapFromProto(const v1::TrackedMap& proto,
                                                          const std::string& field) {
  TrackedPlanState::Map map;
  map.size = {proto.width(), proto.height()};
  if (absl::Status status = ValidateMapSize(map.size); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(field, ": ", status.message()));
  }
  const absl::StatusOr<Eigen::Matrix4d> map_from_world =
      MatrixFromProto(proto.map_from_world(), absl::StrCat(field, ".map_from_world"));
  if (!map_from_world.ok()) return map_from_world.status();
  map.map_from_world = *map_from_world;
  if (absl::Status status = CheckFrames(proto.frames_kept(), field, "frames_kept"); !status.ok()) {
    return status;
  }
  map.frames_kept = proto.frames_kept();
  return map;
}

}  // namespace

v1::PlanTrackerSettings PlanTrackerSettingsToProto(const PlanTrackerOptions& options) {
  v1::PlanTrackerSettings proto;
  proto.set_tolerance(options.tolerance);
  proto.set_update_every_frames(options.update_every_frames);
  proto.set_cover_margin_percent(options.cover_margin_percent);
  return proto;
}

absl::StatusOr<PlanTrackerOptions> PlanTrackerSettingsFromProto(
    const v1::PlanTrackerSettings& proto) {
  if (!std::isfinite(proto.tolerance())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("plan_tracker.tolerance = %g, want a number", proto.tolerance()));
  }
  PlanTrackerOptions options;
  options.tolerance = proto.tolerance();
  options.update_every_frames = proto.update_every_frames();
  options.cover_margin_percent = proto.cover_margin_percent();
  const absl::Status status = ValidatePlanTrackerOptions(options);
  if (status.ok()) return options;
  return absl::InvalidArgumentError(
      absl::StrCat("plan_tracker.", absl::StripPrefix(status.message(), "options.")));
}

v1::ShotPlan ShotPlanToProto(const TrackedPlan& tracked) {
  v1::ShotPlan proto;
  proto.set_is_new(tracked.is_new);
  for (size_t k = 0; k < tracked.actions.size(); ++k) {
    v1::ShotMap& map = *proto.add_maps();
    map.set_action(TrackerActionToProto(tracked.actions[k]));
    map.set_frames_kept(tracked.frames_kept[k]);
  }
  return proto;
}

v1::TrackedState TrackedPlanStateToProto(const TrackedPlanState& state) {
  v1::TrackedState proto;
  proto.set_light(state.light.name);
  proto.set_frames_since_update(state.frames_since_update);
  proto.set_border(BorderToProto(state.border));
  for (const TrackedPlanState::Map& map : state.maps) {
    v1::TrackedMap& added = *proto.mutable_plan()->add_maps();
    added.set_width(map.size.width);
    added.set_height(map.size.height);
    *added.mutable_map_from_world() = MatrixToProto(map.map_from_world);
    added.set_frames_kept(map.frames_kept);
  }
  return proto;
}

absl::StatusOr<TrackedPlanState> TrackedPlanStateFromProto(const v1::TrackedState& proto,
                                                           absl::string_view field) {
  const int num_maps = proto.plan().maps_size();
  if (num_maps < 1 || num_maps > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s.plan.maps: %d of them, want 1 ... %d", field, num_maps, kMaxPlanMaps));
  }
  const absl::StatusOr<Border> border =
      BorderFromProto(proto.border(), absl::StrCat(field, ".border"));
  if (!border.ok()) return border.status();
  absl::Status status = CheckFrames(proto.frames_since_update(), field, "frames_since_update");
  if (!status.ok()) return status;
  TrackedPlanState state;
  state.light.name = proto.light();
  state.border = *border;
  state.frames_since_update = proto.frames_since_update();
  for (int k = 0; k < num_maps; ++k) {
    const absl::StatusOr<TrackedPlanState::Map> map =
        TrackedMapFromProto(proto.plan().maps(k), absl::StrCat(field, ".plan.maps[", k, "]"));
    if (!map.ok()) return map.status();
    state.maps.push_back(*map);
  }
  return state;
}

}  // namespace lightfit
