// calls/request_options.h
//
// How a request wants its fits done.
// In:   v1::FitOptions.
// Out:  FitOptions whose memory is bounded.
#pragma once

#include "absl/status/statusor.h"
#include "lightfit/v1/options.pb.h"
#include "optimizer/fit_options.h"

namespace lightfit {

// Rounds and directions of a search. Each keeps something in memory; results stand still long
// before.
inline constexpr int kMaxSearchSteps = 1000;

// InvalidArgument names the field.
absl::StatusOr<FitOptions> OptionsOfRequest(const v1::FitOptions& options);

}  // namespace lightfit
