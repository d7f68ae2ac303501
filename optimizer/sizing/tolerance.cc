#include "optimizer/sizing/tolerance.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "geometry/map_size.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/energy/reweighting.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/enough_samples.h"
#include "optimizer/sizing/map_shapes.h"

namespace lightfit {

namespace {

// Fits a map of one size and measures the tolerance's figure there; is_met is still open.
using TryFunction = std::function<absl::StatusOr<ToleranceMap>(MapSize)>;

// Footprints of all samples, read-back pixels per texel; 0 behind the light's plane w = 0, where a
// lit neighbour of what is covered may lie: look-ups there find light. Of no use once `stop` says
// so.
ScratchVector<double> FootprintsOf(const Eigen::Matrix3d& map_from_ray, const Samples& samples) {
  ScratchVector<double> footprints(samples.size(), 0.0);
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    if (!(map_from_ray.row(2).dot(samples.At(i).X) > 0.0)) continue;
    footprints[i] = std::sqrt(0.5) * Footprint(map_from_ray, samples.At(i)).norm();
  }
  return footprints;
}

// Kind::kP99 and kWorst: the least value that 99 % or all of the samples do not exceed.
double FigureOf(Tolerance::Kind kind, ScratchVector<double> footprints) {
  footprints.erase(std::remove(footprints.begin(), footprints.end(), 0.0), footprints.end());
  if (footprints.empty()) return 0.0;
  const double share = kind == Tolerance::Kind::kP99 ? 0.99 : 1.0;
  const auto rank =
      static_cast<size_t>(std::ceil(share * static_cast<double>(footprints.size()))) - 1;
  std::nth_element(footprints.begin(), footprints.begin() + rank, footprints.end());
  return footprints[rank];
}

double RmsOf(const ScratchVector<double>& footprints, const ScratchVector<double>& weights) {
  double sum_squared = 0.0, sum_weight = 0.0;
  for (size_t i = 0; i < footprints.size(); ++i) {
    if (footprints[i] == 0.0) continue;
    sum_squared += weights[i] * footprints[i] * footprints[i];
    sum_weight += weights[i];
  }
  return sum_weight > 0.0 ? std::sqrt(sum_squared / sum_weight) : 0.0;
}

absl::StatusOr<Eigen::Matrix3d> MapFromNormalized(const LightMatrix& matrix,
                                                  const Light& light,
                                                  const RayCover& cover) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(matrix.map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  return *map_from_ray * cover.normalized_from_ray.inverse();
}

// How the weights of the next round follow from the footprints of this one.
enum class Reweighting {
  kTowardsFew,   // Lawson: times the footprint over the figure, so that in time those samples weigh
                 // the most that decide the figure; those beyond it weigh little
  kTowardsMany,  // over the footprint, which makes sums of footprints of squares (math.md 4)
};

ScratchVector<double> Reweighted(Reweighting reweighting,
                                 const ScratchVector<double>& weights,
                                 const ScratchVector<double>& footprints,
                                 double figure) {
  constexpr double kBeyond = 0.1, kFloor = 0.01;  // of the figure
  ScratchVector<double> result(weights.size());
  for (size_t i = 0; i < weights.size(); ++i) {
    const double ratio = std::max(footprints[i] / figure, kFloor);
    result[i] = reweighting == Reweighting::kTowardsMany ? 1.0 / ratio
                : ratio <= 1.0                           ? weights[i] * ratio
                                                         : weights[i] * kBeyond;
  }
  return result;
}

// The summary whose least sum of squares brings the figure lowest in maps of this shape, of a few
// rounds' weights.
absl::StatusOr<Summary> SummaryFor(Tolerance::Kind kind,
                                   const LightView& view,
                                   const Summary& unweighted,
                                   MapSize map,
                                   const FitOptions& options) {
  constexpr int kRounds = 12;
  const Light& light = *view.light;
  BestOfRounds<Summary> best;
  // From squares towards the few; and from sums of footprints, the better start where 1 % of the
  // samples may be as bad as they like.
  for (const int rounds_towards_many : {0, kRounds / 2}) {
    Samples samples = view.samples;
    Summary summary = unweighted;
    for (int round = 0; round < kRounds; ++round) {
      const absl::StatusOr<LightMatrix> fit = FitMatrix({light, summary}, map, options);
      if (!fit.ok()) return fit.status();
      const absl::StatusOr<Eigen::Matrix3d> map_from_ray =
          MapFromNormalized(*fit, light, summary.cover);
      if (!map_from_ray.ok()) return map_from_ray.status();
      const ScratchVector<double> footprints = FootprintsOf(*map_from_ray, samples);
      const double figure = FigureOf(kind, footprints);
      best.Offer(figure, summary);
      const Reweighting reweighting =
          round < rounds_towards_many ? Reweighting::kTowardsMany : Reweighting::kTowardsFew;
      samples.weight = Reweighted(reweighting, samples.weight, footprints, figure);
      summary = SummarizeSamples(samples, unweighted.cover, unweighted.metric);
    }
  }
  return std::move(best).Best();
}

// What to fit: the squares themselves for the root mean square; else the best weights for square
// maps, which is what the largest are, and for maps of the aspect that squares like best.
absl::StatusOr<std::vector<Summary>> SummariesFor(Tolerance::Kind kind,
                                                  const LightView& view,
                                                  const FitOptions& options) {
  const Summary unweighted = SummaryOfView(view, options);
  if (kind == Tolerance::Kind::kRms) return std::vector<Summary>{unweighted};
  const absl::StatusOr<MapShapes> shapes = FindMapShapes(unweighted, *view.light, options);
  if (!shapes.ok()) return shapes.status();
  std::vector<Summary> summaries;
  for (const MapSize map : {MapSize{4096, 4096}, shapes->BestMap()}) {
    absl::StatusOr<Summary> summary = SummaryFor(kind, view, unweighted, map, options);
    if (!summary.ok()) return summary.status();
    summaries.push_back(*std::move(summary));
  }
  return summaries;
}

// The smallest size whose figure keeps the tolerance, or the largest.
absl::StatusOr<ToleranceMap> SmallestWithin(const Summary& summary,
                                            const Light& light,
                                            const Tolerance& tolerance,
                                            const MapSizeRules& rules,
                                            const FitOptions& options,
                                            const TryFunction& try_size) {
  const absl::StatusOr<MapShapes> shapes = FindMapShapes(summary, light, options);
  if (!shapes.ok()) return shapes.status();
  const std::vector<RatedSize> sizes = RateSizes(*shapes, /*weight=*/1.0, rules);
  absl::StatusOr<ToleranceMap> best = try_size(sizes.back().map);
  if (!best.ok()) return best;
  best->is_met = best->reached_px <= tolerance.limit_px;
  if (!best->is_met) return best;
  // `high` has been measured to hold, what lies before `low` not to.
  size_t low = 0, high = sizes.size() - 1;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    absl::StatusOr<ToleranceMap> trial = try_size(sizes[middle].map);
    if (!trial.ok()) return trial;
    trial->is_met = trial->reached_px <= tolerance.limit_px;
    if (trial->is_met) {
      high = middle;
      best = std::move(trial);
    } else {
      low = middle + 1;
    }
  }
  return best;
}

bool IsBetter(const ToleranceMap& a, const ToleranceMap& b) {
  if (a.is_met != b.is_met) return a.is_met;
  if (!a.is_met) return a.reached_px < b.reached_px;
  return TexelsOf(a.matrix.map) < TexelsOf(b.matrix.map);
}

absl::Status Validate(const Tolerance& tolerance,
                      const MapSizeRules& rules,
                      const FitOptions& options) {
  if (absl::Status status = ValidateTolerance(tolerance); !status.ok()) return status;
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  return ValidateMapSizeRules(rules, options.margin_texels);
}

}  // namespace

absl::Status ValidateTolerance(const Tolerance& tolerance) {
  for (const auto& [field, value] : {std::pair{"limit_px", tolerance.limit_px},
                                     std::pair{"image_scale", tolerance.image_scale}}) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("tolerance.%s = %g, want a number above 0", field, value));
    }
  }
  return absl::OkStatus();
}

FitOptions ToleranceOptions(FitOptions options) {
  options.metric = Metric::kL2;
  return options;
}

absl::StatusOr<ToleranceMap> MeetTolerance(const Readback& readback,
                                           const Light& light,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options) {
  const FitOptions squares = ToleranceOptions(options);
  if (absl::Status status = Validate(tolerance, rules, squares); !status.ok()) return status;
  return AskView(readback, light, squares, [&](const LightView& view) {
    return MeetTolerance(view, tolerance, rules, squares);
  });
}

absl::StatusOr<ToleranceMap> MeetTolerance(const LightView& view,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options) {
  const FitOptions squares = ToleranceOptions(options);
  if (absl::Status status = Validate(tolerance, rules, squares); !status.ok()) return status;
  if (absl::Status status = CheckServes(view, squares); !status.ok()) return status;
  if (!view.cover.ok()) return view.cover.status();
  const Light& light = *view.light;
  if (absl::Status status = CheckEnoughSamples(light, view.samples.counts, squares); !status.ok()) {
    return status;
  }
  const absl::StatusOr<std::vector<Summary>> summaries =
      SummariesFor(tolerance.kind, view, squares);
  if (!summaries.ok()) return summaries.status();

  absl::StatusOr<ToleranceMap> best = absl::UnknownError("not tried");
  for (const Summary& summary : *summaries) {
    const auto try_size = [&](MapSize map) -> absl::StatusOr<ToleranceMap> {
      absl::StatusOr<LightMatrix> matrix = FitMatrix({light, summary}, map, squares);
      if (!matrix.ok()) return matrix.status();
      const absl::StatusOr<Eigen::Matrix3d> map_from_ray =
          MapFromNormalized(*matrix, light, summary.cover);
      if (!map_from_ray.ok()) return map_from_ray.status();
      const ScratchVector<double> footprints = FootprintsOf(*map_from_ray, view.samples);
      const double figure = tolerance.kind == Tolerance::Kind::kRms
                                ? RmsOf(footprints, view.samples.weight)
                                : FigureOf(tolerance.kind, footprints);
      if (options.compute_statistics) {
        matrix->figures.footprint = ComputeFootprintStatistics(*map_from_ray, view.samples);
        // Its rank is rounded there, where a promise counts up.
        if (tolerance.kind == Tolerance::Kind::kP99) matrix->figures.footprint.p99 = figure;
      }
      if (absl::Status status = CheckStop(light); !status.ok()) return status;
      ToleranceMap trial;
      trial.reached_px = figure * tolerance.image_scale;
      trial.num_samples = static_cast<int64_t>(
          footprints.size() - std::count(footprints.begin(), footprints.end(), 0.0));
      trial.matrix = *std::move(matrix);
      return trial;
    };
    absl::StatusOr<ToleranceMap> map =
        SmallestWithin(summary, light, tolerance, rules, squares, try_size);
    if (!map.ok()) return map;
    if (!best.ok() || IsBetter(*map, *best)) best = std::move(map);
  }
  return best;
}

absl::StatusOr<ToleranceMap> MeetTolerance(const Summary& summary,
                                           const Light& light,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options) {
  if (absl::Status status = Validate(tolerance, rules, options); !status.ok()) return status;
  if (tolerance.kind != Tolerance::Kind::kRms || options.metric != Metric::kL2) {
    return absl::InvalidArgumentError(
        "tolerance: a summary can serve the root mean square only, and only when it was summed in "
        "squared footprints (options.metric = kL2); for other tolerances give the read-back");
  }
  if (absl::Status status = CheckEnoughSamples(light, summary.counts, options); !status.ok()) {
    return status;
  }
  const auto try_size = [&](MapSize map) -> absl::StatusOr<ToleranceMap> {
    absl::StatusOr<LightMatrix> matrix = FitMatrix({light, summary}, map, options);
    if (!matrix.ok()) return matrix.status();
    ToleranceMap trial;
    trial.reached_px = matrix->figures.footprint.rms * tolerance.image_scale;
    trial.num_samples = summary.counts.used;
    trial.matrix = *std::move(matrix);
    return trial;
  };
  return SmallestWithin(summary, light, tolerance, rules, options, try_size);
}

}  // namespace lightfit
