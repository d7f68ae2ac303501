// calls/summary_request.h
//
// The summaries of a request, added up.
// In:   repeated v1::SummaryFile, and the same as bytes of files.
// Out:  one SummarySet, and the options to fit it by.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "lightfit/v1/options.pb.h"
#include "lightfit/v1/summary.pb.h"
#include "optimizer/fit_options.h"
#include "wire/summary_set.h"

namespace lightfit {

// InvalidArgument names the summary, as "summary_files[3]: ...", both where a frame is in two of
// them, and when there is none;
// ResourceExhausted above limits.max_summaries; Cancelled.
absl::StatusOr<SummarySet> SummariesOfRequest(
    const google::protobuf::RepeatedPtrField<v1::SummaryFile>& summaries,
    const google::protobuf::RepeatedPtrField<std::string>& summary_files,
    const CallLimits& limits);

// The search is as asked for. InvalidArgument names a field that asks for other samples, metric or
// cover than `held`, which the summaries were made with.
absl::StatusOr<FitOptions> OptionsOfSummaryRequest(const v1::FitOptions& asked,
                                                   const FitOptions& held);

}  // namespace lightfit
