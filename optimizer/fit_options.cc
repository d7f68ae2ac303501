#include "optimizer/fit_options.h"

namespace lightfit {

FitOptions FitOptions::AsPublished() {
  FitOptions options;
  options.samples.use_outlines = false;
  options.samples.use_terminators = true;
  options.samples.min_cos_light = 0.02;
  options.metric = Metric::kL2;
  options.cover = Cover::kReceivers;
  options.search = Search::kRotationLineSearch;
  options.affine = Affine::kMinAreaRectangle;
  options.ray_space = RaySpace::kLightSpace;
  options.sample_by_sample = true;
  return options;
}

absl::Status ValidateFitOptions(const FitOptions& options) {
  if (absl::Status status = ValidateSampleOptions(options.samples); !status.ok()) return status;
  return ValidateSearchOptions(options);
}

}  // namespace lightfit
