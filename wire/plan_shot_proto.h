// wire/plan_shot_proto.h
//
// What a frame of a shot has beside its plans, to and from lightfit.v1.
// In:   PlanTrackerOptions, TrackedPlan, TrackedPlanState.
// Out:  their messages in lightfit/v1/shot.proto; what a tracker remembers, read back exactly.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "lightfit/v1/shot.pb.h"
#include "partition/tracking/plan_tracker.h"

namespace lightfit {

// Without PlanTrackerOptions::plan, which is FitResult::plan_options.
v1::PlanTrackerSettings PlanTrackerSettingsToProto(const PlanTrackerOptions& options);

// Every field as it is; PlanTrackerOptions::plan stays the default. InvalidArgument names the field
// whose value is out of range, as plan_tracker.FIELD.
absl::StatusOr<PlanTrackerOptions> PlanTrackerSettingsFromProto(
    const v1::PlanTrackerSettings& proto);

// What became of each map.
v1::ShotPlan ShotPlanToProto(const TrackedPlan& tracked);

v1::TrackedState TrackedPlanStateToProto(const TrackedPlanState& state);

// Of the light there is the name alone. Whether matrices are those of the light is seen when they
// are used. InvalidArgument names the field below `field`.
absl::StatusOr<TrackedPlanState> TrackedPlanStateFromProto(const v1::TrackedState& proto,
                                                           absl::string_view field);

}  // namespace lightfit
