// optimizer/fit_options.h
//
// Every choice of the fit: which samples count, what the map must have room for, and the search.
// The defaults are those that leave the fewest wrong shadow pixels: docs/defaults.md.
#pragma once

#include "absl/status/status.h"
#include "geometry/border.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/search/search_options.h"

namespace lightfit {

struct FitOptions : SearchOptions {
  SampleOptions samples;
  Cover cover = Cover::kShadowed;

  // Whether the cover takes in Readback::fine_cover, where there is one.
  bool use_fine_cover = true;

  // What the renderer's look-up finds outside the map, LightMatrix::border. Lit unless asked for:
  // who does not look at the result's border would light what is dark.
  BorderChoice border = BorderChoice::kLit;

  // Worst footprint and percentiles take one more pass over the samples.
  bool compute_statistics = true;

  // Chong & Gortler's Algorithm 1 to the letter: squared footprints, all receivers covered, light
  // space, minimum-area rectangle, three rounds; no samples at depth discontinuities.
  static FitOptions AsPublished();

  // The same, and the usual focused shadow map without a warp, beside a fit: with its margin, its
  // min_samples, and what its surfaces were found with.
  static FitOptions AsPublished(const FitOptions& beside);
  static FitOptions Focused(const FitOptions& beside);
};

absl::Status ValidateFitOptions(const FitOptions& options);

}  // namespace lightfit
