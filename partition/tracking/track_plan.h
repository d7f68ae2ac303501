// partition/tracking/track_plan.h
//
// One frame of a tracked plan: what becomes of the maps of the frame before.
// In:   a read-back's Surfaces, what is remembered of the light, options.
// Out:  TrackedPlan; nothing is remembered here.   docs/sequences.md
#pragma once

#include "absl/status/statusor.h"
#include "optimizer/readback/surfaces.h"
#include "partition/tracking/plan_tracker.h"

namespace lightfit {

// `state.light` and the options are valid. Errors as PlanTracker::Update().
absl::StatusOr<TrackedPlan> TrackPlan(const Surfaces& surfaces,
                                      const TrackedPlanState& state,
                                      const PlanTrackerOptions& options);

}  // namespace lightfit
