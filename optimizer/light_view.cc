#include "optimizer/light_view.h"

#include <Eigen/LU>

#include "absl/strings/str_format.h"
#include "base/stop.h"

namespace lightfit {

absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
                                    const FitOptions& options) {
  const bool is_dark = options.border == BorderChoice::kDark;
  return ViewLight(surfaces, light, is_dark ? Border::kDark : Border::kLit, options);
}

absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
                                    Border border,
                                    const FitOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (options.samples.max_depth_bend != surfaces.options.max_depth_bend ||
      options.samples.depth_noise != surfaces.options.depth_noise) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "options.samples: max_depth_bend = %g and depth_noise = %g are not those that the surfaces "
        "were found with, %g and %g; find them anew (FindSurfaces)",
        options.samples.max_depth_bend,
        options.samples.depth_noise,
        surfaces.options.max_depth_bend,
        surfaces.options.depth_noise));
  }
  LightView view = {&surfaces,
                    &light,
                    options.samples,
                    border,
                    CoverReceivers(surfaces, light, options.cover, border, options.use_fine_cover),
                    Samples()};
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  view.samples =
      SelectSamples(surfaces,
                    light,
                    options.samples,
                    view.normalized_from_ray(),
                    /*with_edge_normals=*/metric.across_edge > 0.0,
                    border == Border::kDark ? FacingSource::kGiven : FacingSource::kGuessed);
  if (border == Border::kDark && options.cover == Cover::kShadowed && view.cover.ok()) {
    view.samples = SamplesServed(view.samples);
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return view;
}

absl::Status CheckServes(const LightView& view, const FitOptions& options) {
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  const bool lacks_normals =
      metric.across_edge > 0.0 && view.samples.size() > 0 && !view.samples.has_edge_normals();
  SampleOptions chosen = view.sample_options;
  chosen.min_samples = options.samples.min_samples;  // counted later
  const bool other_border =
      options.border != BorderChoice::kAutomatic &&
      (options.border == BorderChoice::kDark) != (view.border == Border::kDark);
  if (!lacks_normals && !other_border && chosen == options.samples) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "light \"%s\": the view was made with other %s; make one with the same options (ViewLight)",
      view.light->name,
      other_border    ? "options.border"
      : lacks_normals ? "options.metric, which does not look across edges"
                      : "options.samples"));
}

Summary SummaryOfView(const LightView& view, const FitOptions& options) {
  Summary summary = SummarizeSamples(
      view.samples, *view.cover, WeightsOf(options.metric, options.along_edge_share));
  summary.facing = view.facing();
  return summary;
}

}  // namespace lightfit
