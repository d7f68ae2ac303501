// jobs/shot/whole_plans.h
//
// One plan per light for all frames of a shot.
// In:   ShotContext; every frame is read once more.
// Out:  the plans.
//
// Every frame has no more samples and bins than its share of what fits in memory; of a shot of up
// to some thirty frames all count.
#pragma once

#include "jobs/shot/answer.h"
#include "jobs/shot/context.h"

namespace lightfit {

// With a lit border unless the job's fit asks for the dark one: nothing is foretold of a shot.
// Frames that have nothing of a light are not covered for certain; a note says so.
ShotAnswers FitShotPlans(ShotContext* context);

}  // namespace lightfit
