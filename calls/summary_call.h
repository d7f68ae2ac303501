// calls/summary_call.h
//
// The call FitSummary: one matrix per light for all the frames that summaries were made of.
// In:   v1::FitSummaryRequest.
// Out:  v1::FitResult, as `lightfit fit --summary --json` writes it.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"

namespace lightfit {

// Errors of the call as a whole: InvalidArgument, ResourceExhausted (CallLimits), Cancelled.
absl::StatusOr<v1::FitResult> AnswerFitSummary(const v1::FitSummaryRequest& request,
                                               const CallContext& context);

}  // namespace lightfit
