#include "optimizer/fit_matrix.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/light_map.h"

namespace lightfit {

namespace {

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

// The matrix of a map, with a depth row laid over the receivers, and its footprints.
absl::StatusOr<LightMatrix> LayMatrix(const SearchInputs& inputs,
                                      const Eigen::Matrix3d& map_from_normalized,
                                      MapSize map,
                                      const FitOptions& options) {
  const Summary& summary = inputs.summary;
  const Light& light = inputs.light;
  const Eigen::Vector3d axis = map_from_normalized.row(2);
  const auto [w_min, w_max] = RangeOfW(summary.cover.hull, axis);
  if (!(w_min > 0.0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": the map has w <= 0 on a ray that it must cover", light.name));
  }
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
  matrix.border = summary.cover.border;
  matrix.facing = summary.facing;
  const absl::StatusOr<Eigen::Matrix4d> map_from_world =
      FinishMap(map_from_normalized * summary.cover.normalized_from_ray,
                RayFromWorld(light),
                light,
                depth,
                w_min_map);
  if (!map_from_world.ok()) return map_from_world.status();
  matrix.map_from_world = *map_from_world;
  matrix.figures.samples = summary.counts;
  if (inputs.samples != nullptr && options.compute_statistics) {
    matrix.figures.footprint = ComputeFootprintStatistics(map_from_normalized, *inputs.samples);
  } else if (summary.counts.used > 0 && options.metric == Metric::kL2) {
    const double energy = summary.tensor.Energy(map_from_normalized);
    matrix.figures.footprint.rms = std::sqrt(std::max(0.0, 0.5 * energy / summary.total_weight));
    if (!std::isfinite(matrix.figures.footprint.rms)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("light \"%s\": the summary is damaged: its total_weight = %g is not that "
                          "of samples with an energy of %g; summarise its frames anew",
                          light.name,
                          summary.total_weight,
                          energy));
    }
  }
  return matrix;
}

}  // namespace

absl::StatusOr<LightMatrix> FitMatrix(const SearchInputs& inputs,
                                      MapSize map,
                                      const FitOptions& options,
                                      SearchEffort effort) {
  const Summary& summary = inputs.summary;
  const Light& light = inputs.light;
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  const bool searches = options.search != Search::kFocused;
  if (searches && summary.counts.used < options.samples.min_samples) {
    FitOptions focused = options;
    focused.search = Search::kFocused;
    focused.affine = Affine::kMinAreaRectangle;
    absl::StatusOr<LightMatrix> matrix = FitMatrix(inputs, map, focused, effort);
    if (matrix.ok()) matrix->search.stop_reason = StopReason::kTooFewSamples;
    return matrix;
  }
  absl::StatusOr<SearchResult> result = SearchAxis(inputs, map, options, effort);
  if (!result.ok()) return result.status();
  const Eigen::Matrix3d map_from_normalized = Unmirrored(result->fit.map_from_ray, map);
  absl::StatusOr<LightMatrix> matrix = LayMatrix(inputs, map_from_normalized, map, options);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (!matrix.ok()) return matrix.status();
  matrix->figures.energy = result->fit.energy;
  matrix->search = std::move(result->report);
  const double w_min = RangeOfW(summary.cover.hull, map_from_normalized.row(2)).first;
  if (searches && w_min <= options.min_w * (1.0 + 1e-3)) {
    matrix->search.stop_reason = StopReason::kAxisAtLimit;
  }
  return matrix;
}

absl::StatusOr<LightMatrix> MatrixOfMap(const SearchInputs& inputs,
                                        const Eigen::Matrix3d& map_from_normalized,
                                        MapSize map,
                                        const FitOptions& options) {
  absl::StatusOr<LightMatrix> matrix =
      LayMatrix(inputs, Unmirrored(map_from_normalized, map), map, options);
  if (!matrix.ok()) return matrix;
  if (inputs.summary.counts.used > 0) {
    matrix->figures.energy =
        inputs.samples != nullptr
            ? MeasureEnergy(
                  *inputs.samples, map_from_normalized, options.metric, options.along_edge_share)
            : inputs.summary.tensor.Energy(map_from_normalized);
    matrix->search.energy_start = matrix->figures.energy;
    matrix->search.stop_reason = StopReason::kNoSearch;
  }
  if (absl::Status status = CheckStop(inputs.light); !status.ok()) return status;
  return matrix;
}

}  // namespace lightfit
