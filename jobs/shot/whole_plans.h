// jobs/shot/whole_plans.h
//
// One plan per light for all frames of a shot.
// In:   each frame's FrameViews, while it is in memory; then ShotContext::ray_sums.
// Out:  the plans.
//
// Every frame has no more samples and bins than its share of what fits in memory; of a shot of up
// to some thirty frames all count.
#pragma once

#include "jobs/shot/answer.h"
#include "jobs/shot/context.h"
#include "jobs/shot/judge.h"

namespace lightfit {

// One frame's part in each light's sum, or why it has none.
FrameRaySums SumRaysOfFrame(const ShotJob& job, const FrameViews& views);

// From context->ray_sums, which is empty then. With a lit border unless the job's fit asks for the
// dark one: nothing is foretold of a shot. Frames that have nothing of a light are not covered for
// certain; a note says so.
ShotAnswers FitShotPlans(ShotContext* context);

}  // namespace lightfit
