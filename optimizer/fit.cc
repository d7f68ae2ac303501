#include "optimizer/fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "optimizer/axis_search.h"
#include "optimizer/l1_weights.h"
#include "optimizer/receivers.h"

namespace lightfit {

namespace {

absl::Status ValidateMap(MapSize map, double margin_texels) {
  constexpr int kMaxMapSize = 1 << 20;
  if (map.width < 1 || map.height < 1 || map.width > kMaxMapSize || map.height > kMaxMapSize) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "map = %dx%d, want 1 ... %d texels each way", map.width, map.height, kMaxMapSize));
  }
  if (2.0 * margin_texels >= std::min(map.width, map.height)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.margin_texels = %g leaves nothing of a map of %dx%d texels",
                        margin_texels,
                        map.width,
                        map.height));
  }
  return absl::OkStatus();
}

absl::Status TooFewSamplesError(const Light& light, const SampleCounts& counts, int min_samples) {
  if (counts.candidates == 0) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": no shadow boundary among %d receivers: all are lit, or all are shadowed, so "
        "there is nothing to fit. Leave the light out, or take its focused map (search kFocused, "
        "--search focused)",
        light.name,
        counts.receivers));
  }
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": %d usable samples, want at least %d; of %d boundary pixels %d are background, "
      "%d at depth discontinuities, %d face away from the light, %d are edge-on. Use a larger "
      "read-back, or take the focused map (search kFocused, --search focused)",
      light.name,
      counts.used,
      min_samples,
      counts.candidates,
      counts.background,
      counts.discontinuity,
      counts.facing_away,
      counts.edge_on));
}

// The largest and smallest w over the hull, where w is 1 at the origin of the rays.
std::pair<double, double> RangeOfW(const Polygon& hull, const Eigen::Vector3d& axis) {
  std::pair<double, double> range = {std::numeric_limits<double>::infinity(), 0.0};
  for (const Eigen::Vector2d& ray : hull) {
    const double w = axis.dot(ray.homogeneous());
    range = {std::min(range.first, w), std::max(range.second, w)};
  }
  return range;
}

// The same over all rays that land in the map, which may be more than the hull: lit receivers among
// them must not be clipped. Where the warp leaves no bound the hull's is stretched: the lower one
// by little, as the depth of a directional light pays for it; the upper one, of a point light, by
// much, as 1 / w hardly does.
std::pair<double, double> RangeOfWOverMap(MapSize map,
                                          const Eigen::Matrix3d& map_from_normalized,
                                          double w_min,
                                          double w_max) {
  constexpr double kMostStretchBelow = 16.0, kMostStretchAbove = 1e6;
  const Eigen::Matrix3d normalized_from_map = map_from_normalized.inverse();
  std::pair<double, double> range = {w_min, w_max};
  for (const double u : {0.0, static_cast<double>(map.width)}) {
    for (const double v : {0.0, static_cast<double>(map.height)}) {
      // The ray with w = 1 there; its third component says what w is when that is 1.
      const double z = normalized_from_map.row(2).dot(Eigen::Vector3d(u, v, 1.0));
      const double w = z > 0.0 ? 1.0 / z : std::numeric_limits<double>::infinity();
      range = {std::min(range.first, w), std::max(range.second, w)};
    }
  }
  return {std::max(range.first, w_min / kMostStretchBelow),
          std::min(range.second, w_max * kMostStretchAbove)};
}

absl::StatusOr<LightMatrix> FitInputs(const SearchInputs& inputs,
                                      MapSize map,
                                      const FitOptions& options) {
  const Summary& summary = inputs.summary;
  const Light& light = inputs.light;
  if (options.search != Search::kFocused && summary.counts.used < options.samples.min_samples) {
    return TooFewSamplesError(light, summary.counts, options.samples.min_samples);
  }
  absl::StatusOr<SearchOutcome> outcome = SearchAxis(inputs, map, options);
  if (!outcome.ok()) return outcome.status();
  Eigen::Matrix3d map_from_normalized = outcome->result.fit.map_from_ray;
  // Seen from the light the map must not be mirrored, or triangles change their facing.
  if (map_from_normalized.determinant() < 0.0) {
    map_from_normalized.row(1) =
        map.height * map_from_normalized.row(2) - map_from_normalized.row(1);
  }
  const Eigen::Vector3d axis = map_from_normalized.row(2);
  const auto [w_min, w_max] = RangeOfW(summary.cover.hull, axis);
  const auto [w_min_map, w_max_map] = options.cover == Cover::kShadowed
                                          ? RangeOfWOverMap(map, map_from_normalized, w_min, w_max)
                                          : std::pair(w_min, w_max);
  DepthRange depth = summary.cover.depth;
  if (light.kind == Light::Kind::kPoint) {
    // w of a receiver is its depth times that of its ray.
    depth = {depth.near * w_min, depth.far * w_max_map};
  }

  LightMatrix matrix;
  matrix.light_name = light.name;
  matrix.map = map;
  matrix.map_from_world = MapFromWorld(map_from_normalized * summary.cover.normalized_from_ray,
                                       RayFromWorld(light),
                                       light,
                                       depth,
                                       w_min_map);
  if (!matrix.map_from_world.allFinite()) {
    return absl::InternalError(
        absl::StrFormat("light \"%s\": the matrix is not finite; please report this", light.name));
  }
  matrix.energy = outcome->result.fit.energy;
  matrix.energy_start = outcome->energy_start;
  matrix.samples = summary.counts;
  matrix.evaluations = outcome->evaluations;
  matrix.trace = std::move(outcome->result.trace);
  matrix.solver_report = std::move(outcome->solver_report);
  matrix.stop_reason = outcome->result.stop_reason;
  const bool searched = options.search != Search::kFocused;
  if (searched && w_min <= options.min_w * (1.0 + 1e-3)) {
    matrix.stop_reason = StopReason::kAxisAtLimit;
  }
  if (inputs.samples != nullptr && options.compute_statistics) {
    matrix.footprint = ComputeFootprintStatistics(map_from_normalized, *inputs.samples);
  } else if (summary.counts.used > 0 && options.metric == Metric::kL2) {
    matrix.footprint.rms = std::sqrt(0.5 * matrix.energy / summary.total_weight);
  }
  return matrix;
}

// A light's samples and summary, as the options ask.
struct Prepared {
  Samples samples;
  Summary summary;
};

absl::StatusOr<Prepared> Prepare(const Receivers& receivers,
                                 const Light& light,
                                 const FitOptions& options) {
  absl::StatusOr<RayCover> cover = CoverReceivers(receivers, light, options.cover);
  if (!cover.ok()) return cover.status();
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  Prepared prepared;
  prepared.samples = SelectSamples(
      receivers, light, cover->normalized_from_ray, /*with_edge_normals=*/metric.across_edge > 0.0);
  prepared.summary = SummarizeSamples(prepared.samples, *cover, metric);
  return prepared;
}

}  // namespace

LightMatrices FitLights(const Readback& readback,
                        absl::Span<const Light> lights,
                        MapSize map,
                        const FitOptions& options) {
  LightMatrices results(lights.size());
  absl::Status status = ValidateFitOptions(options);
  if (status.ok()) status = ValidateMap(map, options.margin_texels);
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
    } else if (absl::StatusOr<Prepared> prepared = Prepare(*receivers, lights[i], options);
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

absl::StatusOr<Summary> Summarize(const Readback& readback,
                                  const Light& light,
                                  const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options.samples);
  if (!receivers.ok()) return receivers.status();
  absl::StatusOr<Prepared> prepared = Prepare(*receivers, light, options);
  if (!prepared.ok()) return prepared.status();
  Summary& summary = prepared->summary;
  if (IsL1(options.metric) && summary.counts.used > 0) {
    // The weights come from the best map of this read-back; its size does not matter, as footprints
    // in proportion give weights in proportion.
    constexpr MapSize kAnySquare = {1024, 1024};
    const absl::StatusOr<SearchOutcome> outcome =
        SearchAxis({light, summary, &prepared->samples, &*receivers}, kAnySquare, options);
    if (!outcome.ok()) return outcome.status();
    L1Weights l1 =
        WeightsForL1(prepared->samples, summary.metric, outcome->result.fit.map_from_ray);
    prepared->samples.weight = std::move(l1.weights);
    summary = SummarizeSamples(prepared->samples, RayCover(summary.cover), summary.metric);
    summary.footprint_sum = l1.floored_sum;
  }
  return std::move(summary);
}

absl::StatusOr<LightMatrix> Fit(const Summary& summary,
                                const Light& light,
                                MapSize map,
                                const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (absl::Status status = ValidateMap(map, options.margin_texels); !status.ok()) return status;
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
  return FitInputs({light, summary}, map, options);
}

}  // namespace lightfit
