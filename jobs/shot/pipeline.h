// jobs/shot/pipeline.h
//
// The first stage of a shot: per-frame and tracked matrices, and summaries or, for plans, what
// every frame shows.
// In:   ShotContext.
// Out:  files of every frame that is not done, rows of all, and the sum of the summaries.
//
// Frames go through three stations, a few at a time, so that all processors are busy though the
// tracker has to go from frame to frame:
//
//   prepare   read, fit, sum up                        frames in parallel
//   track     the tracker's matrices                   one frame after the other
//   finish    judge against the frame before, write    frames in parallel
//
// While one group of frames is prepared the group before is tracked and that before finished. What
// comes out depends on neither the number of threads nor on where an earlier run was stopped.
#pragma once

#include "absl/status/statusor.h"
#include "jobs/shot/context.h"
#include "wire/summary_set.h"

namespace lightfit {

// The sum is of all frames when kPerShot is asked for and its matrices are not there yet; else it
// is of no use.
absl::StatusOr<SummarySet> FitFrames(ShotContext* context);

// Whether that has to read the frame: a step of its progress.
bool MustReadFrame(const ShotContext& context, size_t frame);

}  // namespace lightfit
