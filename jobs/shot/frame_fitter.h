// jobs/shot/frame_fitter.h
//
// How the lights of a shot's frames are fitted, each frame by itself or tracked: matrices or plans.
// In:   ShotJob; frame after frame what it shows.
// Out:  ShotAnswers.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "io/readback_exr.h"
#include "jobs/shot/answer.h"
#include "jobs/shot/job.h"
#include "jobs/shot/judge.h"

namespace lightfit {

// Every light's best answer in this frame. For any thread.
ShotAnswers FitFrame(const ShotJob& job, const FrameViews& views);

// For one thread, frames in order.
class ShotTracker {
 public:
  // The job must outlive the tracker.
  explicit ShotTracker(const ShotJob& job);

  // A light that the file has no shadow of is left as it was.
  ShotAnswers Track(const absl::StatusOr<ReadbackFile>& file, const FrameViews& views);

  ShotStates states() const;
  void set_states(const ShotStates& states);

 private:
  TrackedMatrices TrackMatrices(const absl::StatusOr<ReadbackFile>& file, const FrameViews& views);

  const ShotJob& job_;
  Tracker matrices_;
  std::vector<PlanTracker> plans_;  // by light; none where matrices are tracked
};

}  // namespace lightfit
