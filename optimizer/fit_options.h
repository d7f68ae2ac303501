// optimizer/fit_options.h
//
// Every choice of the fit: which samples count, what the map must have room for, and the search.
// The defaults are those that leave the fewest wrong shadow pixels: docs/defaults.md.
#pragma once

#include "absl/status/status.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/search/search_options.h"

namespace lightfit {

struct FitOptions : SearchOptions {
  SampleOptions samples;
  Cover cover = Cover::kShadowed;

  // Worst footprint and percentiles take one more pass over the samples.
  bool compute_statistics = true;

  // Chong & Gortler's Algorithm 1 to the letter: squared footprints, all receivers covered, light
  // space, minimum-area rectangle, three rounds; no samples at depth discontinuities.
  static FitOptions AsPublished();
};

absl::Status ValidateFitOptions(const FitOptions& options);

}  // namespace lightfit
