// calls/allocate_call.h
//
// The call Allocate: sizes of shadow maps, by a budget of texels or by a tolerance.
// In:   v1::AllocateRequest, from a read-back or from summaries.
// Out:  v1::Allocation, as `lightfit allocate --json` writes it.
#pragma once

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/allocation.pb.h"
#include "lightfit/v1/service.pb.h"

namespace lightfit {

// Errors of the call as a whole: InvalidArgument, ResourceExhausted (CallLimits), Cancelled.
absl::StatusOr<v1::Allocation> AnswerAllocate(const v1::AllocateRequest& request,
                                              const CallContext& context);

}  // namespace lightfit
