// calls/evaluate_call.h
//
// The call Evaluate: how good the caller's own matrices are.
// In:   v1::EvaluateRequest.
// Out:  v1::EvaluateResult.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/service.pb.h"

namespace lightfit {

// Errors of the call as a whole: InvalidArgument, ResourceExhausted (CallLimits), Cancelled. What
// is wrong with one matrix is its Evaluation.status.
absl::StatusOr<v1::EvaluateResult> AnswerEvaluate(const v1::EvaluateRequest& request,
                                                  const CallContext& context);

}  // namespace lightfit
