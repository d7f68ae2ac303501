#include "partition/tracking/plan_tracker.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "partition/tracking/kept_map.h"
#include "partition/tracking/track_plan.h"

namespace lightfit {

PlanTrackerOptions PlanTrackerOptions::ForStability(double stability) {
  PlanTrackerOptions options;
  options.tolerance = stability;
  options.update_every_frames = stability > 0.0 ? 3 : 1;
  options.cover_margin_percent = 10.0 * stability * stability;
  return options;
}

absl::Status ValidatePlanTrackerOptions(const PlanTrackerOptions& options) {
  if (absl::Status status = ValidatePlanOptions(options.plan); !status.ok()) return status;
  if (!(options.tolerance >= 0.0)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.tolerance = %g, want at least 0", options.tolerance));
  }
  return ValidateUpdates(options.update_every_frames, options.cover_margin_percent);
}

int TrackedPlan::NumRedrawn() const {
  return static_cast<int>(std::count_if(actions.begin(), actions.end(), IsRedrawn));
}

void PlanTracker::set_light(const Light& light) {
  if (!IsSameLight(light, state_.light)) state_.maps.clear();
  state_.light = light;
}

absl::StatusOr<TrackedPlan> PlanTracker::Update(const Surfaces& surfaces) {
  if (absl::Status status = ValidatePlanTrackerOptions(options_); !status.ok()) return status;
  if (absl::Status status = ValidateLight(state_.light); !status.ok()) return status;
  absl::StatusOr<TrackedPlan> tracked = TrackPlan(surfaces, state_, options_);
  if (!tracked.ok()) return tracked;
  state_.border = tracked->plan.border;
  state_.frames_since_update = tracked->is_updated ? 0 : state_.frames_since_update + 1;
  state_.maps.resize(tracked->plan.maps.size());
  for (size_t k = 0; k < state_.maps.size(); ++k) {
    const LightMatrix& map = tracked->plan.maps[k];
    state_.maps[k] = {map.map_from_world, map.map, tracked->frames_kept[k]};
  }
  return tracked;
}

}  // namespace lightfit
