// optimizer/sizing/enough_samples.h
//
// Whether the size of a light's map can be told from its samples.
// In:   SampleCounts, FitOptions.
// Out:  a status.
#pragma once

#include "absl/status/status.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/sample_counts.h"

namespace lightfit {

// A fit makes do with the focused map where samples are few; a size has nothing to go by then.
// FailedPrecondition below SampleOptions::min_samples, unless the focused map was asked for.
absl::Status CheckEnoughSamples(const Light& light,
                                const SampleCounts& counts,
                                const FitOptions& options);

}  // namespace lightfit
