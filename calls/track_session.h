// calls/track_session.h
//
// One stream of Track: frames in, matrices out, the tracker in between.
// In:   v1::TrackSetup, then v1::TrackFrame with their pixels.
// Out:  v1::TrackResult.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <stop_token>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
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
  // InvalidArgument names the field of the setup.
  static absl::StatusOr<TrackSession> Begin(const v1::TrackSetup& setup);

  // A frame that cannot be used is a result with its status, and leaves the tracker as it was.
  // `pixels`: the frame's read-back, or why there is none.
  v1::TrackResult Update(const v1::TrackFrame& frame,
                         const absl::StatusOr<Readback>& pixels,
                         const std::stop_token& stop);

 private:
  absl::StatusOr<v1::FitResult> Track(const v1::TrackFrame& frame, const Readback& pixels);

  // Once, when the first frame says what the lights are.
  absl::Status TakeGivenState(const std::vector<Light>& lights);

  TrackSession(const TrackerOptions& options, MapSize map, const ClipConvention& clip)
      : tracker_(options), map_(map), clip_(clip) {}

  Tracker tracker_;
  MapSize map_;
  ClipConvention clip_;
  // What an earlier stream remembered, until it is taken.
  google::protobuf::RepeatedPtrField<v1::TrackedState> given_state_;
};

}  // namespace lightfit
