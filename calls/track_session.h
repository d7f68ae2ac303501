// calls/track_session.h
//
// One stream of Track: frames in, matrices or plans out, the tracker in between.
// In:   v1::TrackSetup, then v1::TrackFrame with their pixels.
// Out:  v1::TrackResult.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <optional>
#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "calls/plan_trackers.h"
#include "calls/request_lights.h"
#include "geometry/clip.h"
#include "geometry/light.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/readback/readback.h"
#include "optimizer/tracking/tracker.h"

namespace lightfit {

// Not for use by two threads at once.
class TrackSession {
 public:
  // InvalidArgument names the field of the setup; ResourceExhausted above `limits`.
  static absl::StatusOr<TrackSession> Begin(const v1::TrackSetup& setup,
                                            const CallLimits& limits = {});

  // A frame that cannot be used is a result with its status, and leaves the tracker as it was.
  // `pixels`: the frame's read-back, or why there is none.
  v1::TrackResult Update(const v1::TrackFrame& frame,
                         const absl::StatusOr<Readback>& pixels,
                         const std::stop_token& stop);

 private:
  absl::StatusOr<v1::FitResult> Track(const v1::TrackFrame& frame, const Readback& pixels);

  absl::StatusOr<TrackedFits> TrackMatrices(const std::vector<RequestLight>& lights,
                                            const Readback& pixels);

  // Once, when the first frame says what the lights are.
  absl::Status TakeGivenState(const std::vector<Light>& lights);

  TrackSession(const FitOptions& fit_options, const ClipConvention& clip)
      : fit_options_(fit_options), clip_(clip) {}

  FitOptions fit_options_;
  ClipConvention clip_;
  std::optional<PlanTrackers> plans_;  // where plans are asked for; else
  Tracker tracker_{TrackerOptions()};
  MapSize map_;
  // What an earlier stream remembered, until it is taken.
  google::protobuf::RepeatedPtrField<v1::TrackedState> given_state_;
};

}  // namespace lightfit
