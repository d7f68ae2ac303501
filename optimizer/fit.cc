#include "optimizer/fit.h"

#include <Eigen/LU>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "geometry/map_size.h"
#include "optimizer/choose_fit.h"
#include "optimizer/energy/l1_weights.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

namespace {

// For the L1 metrics gives the samples the weights they have in a map, and sums them up.
Summary WeighedIn(const Eigen::Matrix3d& map_from_normalized,
                  Samples samples,
                  const Summary& unweighed) {
  L1Weights l1 = WeightsForL1(samples, unweighed.metric, map_from_normalized);
  samples.weight = std::move(l1.weights);
  Summary summary = SummarizeSamples(samples, unweighed.cover, unweighed.metric);
  summary.footprint_sum = l1.floored_sum;
  summary.facing = unweighed.facing;
  return summary;
}

}  // namespace

uint32_t LightMask(absl::Span<const Light> lights) {
  uint32_t mask = 0;
  for (const Light& light : lights) {
    if (ValidateLight(light).ok()) mask |= uint32_t{1} << light.shadow_bit;
  }
  return mask;
}

LightMatrices FitLights(const Readback& readback,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options) {
  absl::Status status = ValidateFitOptions(options);
  if (status.ok()) status = ValidateMapSize(map, options.margin_texels);
  const absl::StatusOr<Surfaces> surfaces =
      status.ok() ? FindSurfaces(readback, LightMask(lights), options.samples) : status;
  if (!surfaces.ok()) return LightMatrices(lights.size(), surfaces.status());
  return FitLights(*surfaces, lights, map, options);
}

LightMatrices FitLights(const Surfaces& surfaces,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options) {
  LightMatrices results(lights.size());
  for (size_t i = 0; i < lights.size(); ++i) {
    results[i] = FitLight(surfaces, lights[i], map, options);
  }
  return results;
}

absl::StatusOr<LightMatrix> FitLight(const Readback& readback,
                                     const Light& light,
                                     MapSize map,
                                     const FitOptions& options) {
  return std::move(FitLights(readback, absl::MakeConstSpan(&light, 1), map, options).front());
}

absl::StatusOr<LightMatrix> FitLight(const Surfaces& surfaces,
                                     const Light& light,
                                     MapSize map,
                                     const FitOptions& options) {
  if (options.border == BorderChoice::kAutomatic) {
    return FitByForecast(surfaces, light, map, options);
  }
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, options);
  return view.ok() ? FitLight(*view, map, options) : view.status();
}

absl::StatusOr<LightMatrix> FitLight(const LightView& view,
                                     MapSize map,
                                     const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateMapSize(map, options.margin_texels); !status.ok()) {
    return status;
  }
  if (absl::Status status = CheckServes(view, options); !status.ok()) return status;
  if (!view.cover.ok()) return view.cover.status();
  const Summary summary = SummaryOfView(view, options);
  return FitMatrix({*view.light, summary, &view.samples, view.surfaces}, map, options);
}

absl::StatusOr<Summary> Summarize(const Readback& readback,
                                  const Light& light,
                                  const FitOptions& options) {
  return AskView(
      readback, light, options, [&](const LightView& view) { return Summarize(view, options); });
}

absl::StatusOr<Summary> Summarize(const LightView& view, const FitOptions& options) {
  if (absl::Status status = CheckServes(view, options); !status.ok()) return status;
  if (!view.cover.ok()) return view.cover.status();
  const Light& light = *view.light;
  Summary summary = SummaryOfView(view, options);
  if (IsL1(options.metric) && summary.counts.used > 0) {
    // The weights come from the best map of this read-back; its size does not matter, as footprints
    // in proportion give weights in proportion.
    constexpr MapSize kAnySquare = {1024, 1024};
    const absl::StatusOr<SearchResult> result =
        SearchAxis({light, summary, &view.samples, view.surfaces}, kAnySquare, options);
    if (!result.ok()) return result.status();
    summary = WeighedIn(result->fit.map_from_ray, view.samples, summary);
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return summary;
}

absl::StatusOr<Summary> SummarizeInMap(const Readback& readback,
                                       const Light& light,
                                       const Eigen::Matrix4d& map_from_world,
                                       const FitOptions& options) {
  return AskView(readback, light, options, [&](const LightView& view) {
    return SummarizeInMap(view, map_from_world, options);
  });
}

absl::StatusOr<Summary> SummarizeInMap(const LightView& view,
                                       const Eigen::Matrix4d& map_from_world,
                                       const FitOptions& options) {
  const Light& light = *view.light;
  if (absl::Status status = CheckServes(view, options); !status.ok()) return status;
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  if (!view.cover.ok()) return view.cover.status();
  Summary summary = SummaryOfView(view, options);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (!IsL1(options.metric) || summary.counts.used == 0) return summary;
  const Eigen::Matrix3d map_from_normalized =
      *map_from_ray * view.cover->normalized_from_ray.inverse();
  // Of those the map gives no footprint to, the cover is all that is left.
  Samples samples = SamplesInFront(view.samples, map_from_normalized.row(2));
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  samples.counts.used = static_cast<int64_t>(samples.size());
  if (samples.size() == 0) {
    Summary cover_only = SummarizeSamples(samples, *view.cover, summary.metric);
    cover_only.facing = summary.facing;
    return cover_only;
  }
  summary = WeighedIn(map_from_normalized, std::move(samples), summary);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return summary;
}

absl::StatusOr<LightMatrix> Fit(const Summary& summary,
                                const Light& light,
                                MapSize map,
                                const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (absl::Status status = ValidateMapSize(map, options.margin_texels); !status.ok())
    return status;
  if (options.sample_by_sample) {
    return absl::InvalidArgumentError(
        "options.sample_by_sample: a summary has no samples; fit from the read-back (FitLight)");
  }
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  const bool has_weights = summary.footprint_sum > 0.0 || summary.counts.used == 0;
  if (metric.across_edge != summary.metric.across_edge || metric.whole != summary.metric.whole ||
      (IsL1(options.metric) ? !has_weights : summary.footprint_sum > 0.0)) {
    return absl::InvalidArgumentError(
        "options.metric or along_edge_share is not what the samples were summed with: summarise "
        "and fit with the same FitOptions");
  }
  // Done once for a whole shot, however its frames came together.
  return FitMatrix({light, summary}, map, options, SearchEffort::kToTheEnd);
}

}  // namespace lightfit
