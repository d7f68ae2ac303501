// calls/plan_trackers.h
//
// The tracked plans of all lights of a stream.
// In:   frames: read-backs and lights.
// Out:  LightFit with what became of each map; what is remembered, for a stream that goes on.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "calls/request_lights.h"
#include "lightfit/v1/shot.pb.h"
#include "optimizer/readback/readback.h"
#include "partition/tracking/plan_tracker.h"
#include "wire/result_json.h"

namespace lightfit {

// One frame's fits, and what became of the frame before's.
struct TrackedFits {
  std::vector<LightFit> fits;
  std::vector<v1::ShotLight> shots;  // empty for lights without a fit
};

// A copy goes its own way: what a frame did to it counts once it has taken the place of the first.
class PlanTrackers {
 public:
  explicit PlanTrackers(const PlanTrackerOptions& options) : options_(options) {}

  const PlanTrackerOptions& options() const { return options_; }

  // To go on from state(). InvalidArgument names the field as state[i].FIELD.
  absl::Status SetState(const google::protobuf::RepeatedPtrField<v1::TrackedState>& state);

  // In the order of `lights`; those that cannot be used keep their status. Lights are known by
  // their names, and forgotten when a frame is without them.
  TrackedFits Update(const Readback& readback, const std::vector<RequestLight>& lights);

  std::vector<v1::TrackedState> State() const;

 private:
  PlanTracker TrackerOf(const Light& light) const;

  PlanTrackerOptions options_;
  std::vector<PlanTracker> trackers_;
  std::vector<TrackedPlanState> given_;  // until the first frame says what the lights are
};

}  // namespace lightfit
