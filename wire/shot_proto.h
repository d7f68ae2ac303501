// wire/shot_proto.h
//
// What a frame of a shot has beside its matrices, to and from lightfit.v1.
// In:   TrackerOptions, TrackerAction, TrackedState.
// Out:  their messages in lightfit/v1/shot.proto; what a tracker remembers, read back exactly.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "lightfit/v1/shot.pb.h"
#include "optimizer/tracking/tracker.h"

namespace lightfit {

// Without TrackerOptions::fit, which is FitResult::options.
v1::TrackerSettings TrackerSettingsToProto(const TrackerOptions& options);

// Every field as it is; TrackerOptions::fit stays the default. InvalidArgument names the field
// whose value is out of range or not known to this version.
absl::StatusOr<TrackerOptions> TrackerSettingsFromProto(const v1::TrackerSettings& proto);

v1::TrackerAction TrackerActionToProto(TrackerAction action);

v1::TrackedState TrackedStateToProto(const TrackedState& state);

// Of the lights that are among `lights` still. InvalidArgument when a number is none.
absl::StatusOr<std::vector<TrackedState>> TrackedStatesFromProto(const v1::ShotInfo& shot,
                                                                 absl::Span<const Light> lights,
                                                                 MapSize map);

}  // namespace lightfit
