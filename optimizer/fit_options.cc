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

namespace {

void SetWhatIsShared(const FitOptions& beside, FitOptions* options) {
  options->samples.max_depth_bend = beside.samples.max_depth_bend;
  options->samples.depth_noise = beside.samples.depth_noise;
  options->samples.min_samples = beside.samples.min_samples;
  options->margin_percent = beside.margin_percent;
  options->margin_texels = beside.margin_texels;
}

}  // namespace

FitOptions FitOptions::AsPublished(const FitOptions& beside) {
  FitOptions options = AsPublished();
  SetWhatIsShared(beside, &options);
  return options;
}

FitOptions FitOptions::Focused(const FitOptions& beside) {
  FitOptions options;
  SetWhatIsShared(beside, &options);
  options.search = Search::kFocused;
  options.affine = Affine::kMinAreaRectangle;
  options.cover = Cover::kReceivers;
  return options;
}

absl::Status ValidateFitOptions(const FitOptions& options) {
  if (absl::Status status = ValidateSampleOptions(options.samples); !status.ok()) return status;
  return ValidateSearchOptions(options);
}

}  // namespace lightfit
