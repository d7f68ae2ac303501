// jobs/fit_summary.h
//
// Lights fitted from summaries, for the service and for the command line.
// In:   a LightSummary, the options that its samples were summed by and those of the search.
// Out:  its matrix, and what people should know of it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lightfit/v1/result.pb.h"
#include "optimizer/energy/summary.h"
#include "optimizer/light_matrix.h"
#include "wire/summary_set.h"

namespace lightfit {

// The search is as asked for, without statistics; what the samples were summed by is as in the
// summaries. InvalidArgument when the two do not go together.
absl::StatusOr<FitOptions> OptionsForSummaries(const FitOptions& asked, const FitOptions& held);

// The light's sum as Fit() takes it, or why there is none.
absl::StatusOr<Summary> SummaryOf(const LightSummary& light);

absl::StatusOr<LightMatrix> FitSummary(const LightSummary& light,
                                       MapSize map,
                                       const FitOptions& options);

// "light "key": nothing of it in 3 of 24 frames, such as 0007.exr: ...". Empty when all have it.
std::string MissingFramesText(const LightSummary& light);

// Takes out of a result what only a read-back can tell.
void ClearReadbackFigures(v1::ReadbackInfo* readback,
                          google::protobuf::RepeatedPtrField<v1::LightResult>* lights);

// Says MissingFramesText() in the status of lights that have a matrix, whose code stays 0: who
// reads the result alone sees no warning. `lights` belong to `results`, one by one.
void SayMissingFrames(const std::vector<LightSummary>& lights,
                      google::protobuf::RepeatedPtrField<v1::LightResult>* results);

}  // namespace lightfit
