// calls/summarize_call.h
//
// The call Summarize: what a read-back has to say about its lights, for FitSummary.
// In:   v1::SummarizeRequest.
// Out:  v1::SummarizeResult, as `lightfit summarize` has it.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// A light that the read-back has nothing of stops nothing: the summary says so. Errors of the call
// as a whole: InvalidArgument, ResourceExhausted (CallLimits), Cancelled.
absl::StatusOr<v1::SummarizeResult> AnswerSummarize(const v1::SummarizeRequest& request,
                                                    const CallContext& context);

}  // namespace lightfit
