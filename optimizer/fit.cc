#include "optimizer/fit.h"

#include <Eigen/LU>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "geometry/map_size.h"
#include "optimizer/energy/l1_weights.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

LightMatrices FitLights(const Readback& readback,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options) {
  LightMatrices results(lights.size());
  absl::Status status = ValidateFitOptions(options);
  if (status.ok()) status = ValidateMapSize(map, options.margin_texels);
  uint32_t light_mask = 0;
  ScratchVector<absl::Status> light_status;
  for (const Light& light : lights) {
    light_status.push_back(ValidateLight(light));
    if (light_status.back().ok()) light_mask |= uint32_t{1} << light.shadow_bit;
  }
  const absl::StatusOr<Receivers> receivers =
      status.ok() ? FindReceivers(readback, light_mask, options.samples) : status;

  for (size_t i = 0; i < lights.size(); ++i) {
    if (!receivers.ok()) {
      results[i] = receivers.status();
    } else if (!light_status[i].ok()) {
      results[i] = light_status[i];
    } else if (absl::StatusOr<PreparedLight> prepared =
                   PrepareLight(*receivers, lights[i], options);
               !prepared.ok()) {
      results[i] = prepared.status();
    } else {
      results[i] =
          FitInputs({lights[i], prepared->summary, &prepared->samples, &*receivers}, map, options);
    }
  }
  return results;
}

absl::StatusOr<LightMatrix> FitLight(const Readback& readback,
                                     const Light& light,
                                     MapSize map,
                                     const FitOptions& options) {
  return std::move(FitLights(readback, absl::MakeConstSpan(&light, 1), map, options).front());
}

namespace {

// For the L1 metrics gives the samples the weights they have in a map, and sums them up.
void WeighIn(const Eigen::Matrix3d& map_from_normalized,
             PreparedLight* prepared) {
  L1Weights l1 =
      WeightsForL1(prepared->samples, prepared->summary.metric, map_from_normalized);
  prepared->samples.weight = std::move(l1.weights);
  prepared->summary = SummarizeSamples(
      prepared->samples, RayCover(prepared->summary.cover), prepared->summary.metric);
  prepared->summary.footprint_sum = l1.floored_sum;
}

}  // namespace

absl::StatusOr<Summary> Summarize(const Readback& readback,
                                  const Light& light,
                                  const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options.samples);
  if (!receivers.ok()) return receivers.status();
  absl::StatusOr<PreparedLight> prepared = PrepareLight(*receivers, light, options);
  if (!prepared.ok()) return prepared.status();
  if (IsL1(options.metric) && prepared->summary.counts.used > 0) {
    // The weights come from the best map of this read-back; its size does not matter, as footprints
    // in proportion give weights in proportion.
    constexpr MapSize kAnySquare = {1024, 1024};
    const absl::StatusOr<SearchOutcome> outcome = SearchAxis(
        {light, prepared->summary, &prepared->samples, &*receivers}, kAnySquare, options);
    if (!outcome.ok()) return outcome.status();
    WeighIn(outcome->result.fit.map_from_ray, &*prepared);
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return std::move(prepared->summary);
}

absl::StatusOr<Summary> SummarizeInMap(const Readback& readback,
                                       const Light& light,
                                       const Eigen::Matrix4d& map_from_world,
                                       const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options.samples);
  if (!receivers.ok()) return receivers.status();
  absl::StatusOr<PreparedLight> prepared = PrepareLight(*receivers, light, options);
  if (!prepared.ok()) return prepared.status();
  if (!IsL1(options.metric) || prepared->summary.counts.used == 0) {
    return std::move(prepared->summary);
  }
  const Eigen::Matrix3d map_from_normalized =
      *map_from_ray * prepared->summary.cover.normalized_from_ray.inverse();
  // Of those the map gives no footprint to, the cover is all that is left.
  prepared->samples = SamplesInFront(prepared->samples, map_from_normalized.row(2));
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  prepared->samples.counts.used = static_cast<int64_t>(prepared->samples.size());
  if (prepared->samples.size() == 0) {
    return SummarizeSamples(prepared->samples, prepared->summary.cover, prepared->summary.metric);
  }
  WeighIn(map_from_normalized, &*prepared);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return std::move(prepared->summary);
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
        "and "
        "fit with the same FitOptions");
  }
  // Done once for a whole shot, however its frames came together.
  return FitInputs({light, summary, nullptr, nullptr, /*to_the_end=*/true}, map, options);
}

}  // namespace lightfit
