#include "optimizer/light_view.h"

#include <Eigen/LU>

#include "absl/strings/str_format.h"
#include "base/stop.h"

namespace lightfit {

absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
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
                    CoverReceivers(surfaces, light, options.cover),
                    Samples()};
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  view.samples = SelectSamples(surfaces,
                               light,
                               options.samples,
                               view.normalized_from_ray(),
                               /*with_edge_normals=*/metric.across_edge > 0.0);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return view;
}

absl::Status CheckServes(const LightView& view, const FitOptions& options) {
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  const bool lacks_normals =
      metric.across_edge > 0.0 && view.samples.size() > 0 && !view.samples.has_edge_normals();
  SampleOptions chosen = view.sample_options;
  chosen.min_samples = options.samples.min_samples;  // counted later
  if (!lacks_normals && chosen == options.samples) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "light \"%s\": the view was made with other %s; make one with the same options (ViewLight)",
      view.light->name,
      lacks_normals ? "options.metric, which does not look across edges" : "options.samples"));
}

Summary SummaryOfView(const LightView& view, const FitOptions& options) {
  return SummarizeSamples(
      view.samples, *view.cover, WeightsOf(options.metric, options.along_edge_share));
}

}  // namespace lightfit
