// calls/compare/compare_call.h
//
// The call Compare: every way to set up a shadow map, side by side on one read-back.
// In:   v1::CompareRequest.
// Out:  v1::Comparison, as `lightfit compare READBACK.exr --json` has it.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/comparison.pb.h"
#include "lightfit/v1/service.pb.h"

namespace lightfit {

// What is wrong with one light or method is the status of its rows. Errors of the call as a whole:
// InvalidArgument, ResourceExhausted (CallLimits), Cancelled.
absl::StatusOr<v1::Comparison> AnswerCompare(const v1::CompareRequest& request,
                                             const CallContext& context);

}  // namespace lightfit
