// calls/finished_result.h
//
// The last step of calls that fit lights.
// In:   FitReport, and which lights of the request could not be used.
// Out:  v1::FitResult, without a NaN in it.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "calls/request_lights.h"
#include "lightfit/v1/result.pb.h"
#include "wire/result_json.h"

namespace lightfit {

// Lights that could not be used keep their name alone. `lights` belong to report.lights.
absl::StatusOr<v1::FitResult> FinishedResult(const FitReport& report,
                                             const std::vector<RequestLight>& lights);

}  // namespace lightfit
