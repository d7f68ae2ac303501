// calls/fit_call.h
//
// The call Fit: the matrices of a read-back's lights, or their plans.
// In:   v1::FitRequest, with its pixels or beside them.
// Out:  v1::FitResult, as `lightfit fit --json` writes it but for the yardsticks.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// Errors of the call as a whole: InvalidArgument, ResourceExhausted (CallLimits), Cancelled.
absl::StatusOr<v1::FitResult> AnswerFit(const v1::FitRequest& request, const CallContext& context);

// The same where pixels have arrived already: request.readback() has none, or they do not count.
absl::StatusOr<v1::FitResult> AnswerFit(const v1::FitRequest& request,
                                        const Readback& readback,
                                        const CallContext& context);

}  // namespace lightfit
