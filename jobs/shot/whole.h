// jobs/shot/whole.h
//
// The second stage of a shot: one matrix per light for all its frames.
// In:   ShotContext; the sum of the frames' summaries.
// Out:  the matrices in a file of their own, and every frame's figures in them.
//
// The sum weighs each frame's samples in that frame's best map; for the L1 metrics the samples are
// then weighed in the shot's map and summed and fitted anew, a few rounds, and the best map by the
// true sum of footprints over all frames is kept.
#pragma once

#include "absl/status/status.h"
#include "jobs/shot/context.h"
#include "wire/summary_set.h"

namespace lightfit {

// Frames that `sum` has nothing of a light of are not covered for certain.
absl::Status FitWholeShot(const SummarySet& sum, ShotContext* context);

// How many times frames are read for it at most: what FitWholeShot() reports to progress.
int NumWholeShotSteps(const ShotContext& context);

}  // namespace lightfit
