#include "optimizer/fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "optimizer/axis_evaluator.h"
#include "optimizer/global_search.h"
#include "optimizer/line_search.h"
#include "optimizer/polish.h"
#include "optimizer/receivers.h"
#include "optimizer/refine.h"

namespace lightfit {

namespace {

// Keeps reweighted samples of vanishing footprint from weighing everything: a share of the mean.
constexpr double kReweightingFloor = 1e-3;

bool IsL1(Metric metric) { return metric == Metric::kL1 || metric == Metric::kL1AcrossEdge; }

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

// Rays of all receivers in normalised coordinates, for SampleEvaluator.
std::vector<Eigen::Vector3d> ReceiverRays(const Receivers& receivers,
                                          const Eigen::Matrix<double, 3, 4>& ray_from_screen) {
  std::vector<Eigen::Vector3d> rays;
  for (const DepthTile& tile : receivers.tile_grids[0].tiles) {
    if (tile.num_receivers == 0) continue;
    receivers.ForEachReceiver(tile, [&](int x, int y, double d) {
      rays.push_back(ray_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0));
    });
  }
  return rays;
}

// What one light's fit works on. `samples` and `receivers` are null when only a summary is known.
struct Inputs {
  const Light& light;
  const Summary& summary;
  const Samples* samples = nullptr;
  const Receivers* receivers = nullptr;
};

AffineProblem MakeAffineProblem(const Summary& summary, MapSize map, const FitOptions& options) {
  AffineProblem problem;
  problem.map = map;
  problem.affine = options.affine;
  // Without samples no enclosing shape has more energy than another.
  if (summary.counts.used == 0 && problem.affine == Affine::kMinEnergyParallelogram) {
    problem.affine = Affine::kMinAreaRectangle;
  }
  problem.ray_space = options.ray_space;
  problem.normalized_from_ray = summary.cover.normalized_from_ray;
  problem.margin_percent = options.margin_percent;
  problem.margin_texels = options.margin_texels;
  return problem;
}

// The receivers' mean, or the middle of their cone where the mean cannot be used.
std::optional<AffineFit> StartFit(const Summary& summary, AxisEvaluator& evaluator) {
  const Eigen::Vector3d mean =
      summary.cover.normalized_from_ray.inverse().transpose() * summary.cover.mean_ray;
  std::optional<AffineFit> start = evaluator.Evaluate(mean);
  if (!start.has_value()) start = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
  return start;
}

struct SearchOutcome {
  SearchResult result;
  double energy_start = 0.0;
  int evaluations = 0;
  std::string solver_report;
};

absl::StatusOr<SearchOutcome> SearchAxis(const Inputs& inputs,
                                         const Summary& summary,
                                         MapSize map,
                                         const FitOptions& options) {
  const AffineProblem problem = MakeAffineProblem(summary, map, options);
  std::unique_ptr<AxisEvaluator> evaluator;
  if (options.sample_by_sample) {
    evaluator = std::make_unique<SampleEvaluator>(
        *inputs.samples,
        ReceiverRays(*inputs.receivers, inputs.samples->ray_from_screen),
        summary.metric,
        problem,
        options.min_w);
  } else {
    evaluator = std::make_unique<SummaryEvaluator>(summary, problem, options.min_w);
  }
  const std::optional<AffineFit> start = StartFit(summary, *evaluator);
  if (!start.has_value()) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": no axis has all receivers in front of it with room to spare "
                        "(options.min_w = %g)",
                        inputs.light.name,
                        options.min_w));
  }
  SearchOutcome outcome;
  outcome.energy_start = start->energy;
  SearchResult& result = outcome.result;
  int refine_evaluations = 0;
  switch (options.search) {
    case Search::kFocused:
      result.fit = *start;
      result.trace.push_back({"start", evaluator->num_evaluations(), start->energy});
      result.stop_reason = StopReason::kNoSearch;
      break;
    case Search::kRotationLineSearch:
      result = RotationLineSearch(*evaluator, *start, options.line_search_rounds);
      break;
    case Search::kRotationLineSearchRefined: {
      result = RotationLineSearch(*evaluator, *start, options.line_search_rounds);
      RefineResult refined =
          RefineAxis(summary, problem, options.min_w, options.refiner, result.fit);
      refine_evaluations = refined.evaluations;
      result.trace.push_back(
          {"refine", evaluator->num_evaluations() + refine_evaluations, refined.fit.energy});
      const RefineResult polished =
          PolishAxis(summary, problem, options.min_w, Polish::kThorough, refined.fit);
      refine_evaluations += polished.evaluations;
      result.trace.push_back(
          {"polish", evaluator->num_evaluations() + refine_evaluations, polished.fit.energy});
      result.fit = polished.fit;
      result.stop_reason = StopReason::kConverged;
      outcome.solver_report = std::move(refined.report);
      break;
    }
    case Search::kGlobal:
      result = GlobalSearch(summary,
                            *evaluator,
                            *start,
                            options.grid_directions,
                            options.refiner,
                            &outcome.solver_report);
      refine_evaluations = result.trace.back().evaluations - evaluator->num_evaluations();
      break;
  }
  outcome.evaluations = evaluator->num_evaluations() + refine_evaluations;
  return outcome;
}

// Footprints of all samples in the metric: the terms of the L1 energy.
std::vector<double> MetricFootprints(const Samples& samples,
                                     const MetricWeights& metric,
                                     const Eigen::Matrix3d& map_from_ray) {
  const Eigen::Matrix<double, 3, 2> r = map_from_ray.inverse().leftCols<2>();
  std::vector<double> footprints(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const double w = map_from_ray.row(2).dot(sample.X);
    const Eigen::Matrix2d form = r.transpose() * MetricTensor(sample, metric) * r;
    footprints[i] = std::sqrt(w * w * form.trace());
  }
  return footprints;
}

double WeightedSum(const std::vector<double>& values, const std::vector<double>& weights) {
  double sum = 0.0;
  for (size_t i = 0; i < values.size(); ++i) sum += weights[i] * values[i];
  return sum;
}

// L1 by iteratively reweighted least squares: a sample's squared footprint weighs as much as one
// over its footprint in the round before, so that the weighted squares sum to the footprints.
absl::StatusOr<SearchOutcome> SearchL1(const Inputs& inputs,
                                       MapSize map,
                                       const FitOptions& options) {
  if (inputs.samples == nullptr) {
    return absl::InvalidArgumentError(
        "options.metric: the L1 metrics need the samples; fit from the read-back (FitLight), or "
        "choose kL2 or kL2AcrossEdge");
  }
  const MetricWeights metric = inputs.summary.metric;
  const std::vector<double>& weights = inputs.samples->weight;
  Samples reweighted = *inputs.samples;
  std::optional<SearchOutcome> best;
  std::vector<TraceStep> trace;
  double energy_start = 0.0;
  int evaluations = 0;
  for (int round = 0; round < options.reweighting_rounds; ++round) {
    const Summary summary = SummarizeSamples(reweighted, inputs.summary.cover, metric);
    Inputs round_inputs = {inputs.light, summary, &reweighted, inputs.receivers};
    absl::StatusOr<SearchOutcome> outcome = SearchAxis(round_inputs, summary, map, options);
    if (!outcome.ok()) return outcome.status();
    evaluations += outcome->evaluations;
    if (round == 0) {
      FitOptions focused = options;
      focused.search = Search::kFocused;
      absl::StatusOr<SearchOutcome> start = SearchAxis(round_inputs, inputs.summary, map, focused);
      if (!start.ok()) return start.status();
      energy_start = WeightedSum(
          MetricFootprints(*inputs.samples, metric, start->result.fit.map_from_ray), weights);
      trace.push_back({"start", 1, energy_start});
      start->result.fit.energy = energy_start;
      best = *std::move(start);
    }
    const std::vector<double> footprints =
        MetricFootprints(*inputs.samples, metric, outcome->result.fit.map_from_ray);
    const double energy = WeightedSum(footprints, weights);
    trace.push_back({"reweight", evaluations, energy});
    if (energy < best->result.fit.energy) {
      best = *std::move(outcome);
      best->result.fit.energy = energy;
    }
    const double floor =
        kReweightingFloor * WeightedSum(footprints, weights) / inputs.summary.total_weight;
    for (size_t i = 0; i < footprints.size(); ++i) {
      reweighted.weight[i] = weights[i] / std::max(footprints[i], floor);
    }
  }
  best->energy_start = energy_start;
  best->evaluations = evaluations;
  best->result.trace = std::move(trace);
  return *std::move(best);
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

absl::StatusOr<LightMatrix> FitInputs(const Inputs& inputs,
                                      MapSize map,
                                      const FitOptions& options) {
  const Summary& summary = inputs.summary;
  const Light& light = inputs.light;
  if (options.search != Search::kFocused && summary.counts.used < options.samples.min_samples) {
    return TooFewSamplesError(light, summary.counts, options.samples.min_samples);
  }
  absl::StatusOr<SearchOutcome> outcome = IsL1(options.metric) && summary.counts.used > 0
                                              ? SearchL1(inputs, map, options)
                                              : SearchAxis(inputs, summary, map, options);
  if (!outcome.ok()) return outcome.status();
  Eigen::Matrix3d map_from_normalized = outcome->result.fit.map_from_ray;
  // Seen from the light the map must not be mirrored, or triangles change their facing.
  if (map_from_normalized.determinant() < 0.0) {
    map_from_normalized.row(1) =
        map.height * map_from_normalized.row(2) - map_from_normalized.row(1);
  }
  const Eigen::Vector3d axis = map_from_normalized.row(2);
  const auto [w_min, w_max] = RangeOfW(summary.cover.hull, axis);
  DepthRange depth = summary.cover.depth;
  if (light.kind == Light::Kind::kPoint) {
    // w of a receiver is its depth times that of its ray.
    depth = {depth.near * w_min, depth.far * w_max};
  }

  LightMatrix matrix;
  matrix.light_name = light.name;
  matrix.map = map;
  matrix.map_from_world = MapFromWorld(map_from_normalized * summary.cover.normalized_from_ray,
                                       RayFromWorld(light),
                                       light,
                                       depth,
                                       w_min);
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
  absl::StatusOr<RayCover> cover = CoverReceivers(receivers, light);
  if (!cover.ok()) return cover.status();
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  Prepared prepared;
  prepared.samples = SelectSamples(
      receivers, light, cover->normalized_from_ray, /*with_edge_normals=*/metric.across_edge > 0.0);
  prepared.summary = SummarizeSamples(prepared.samples, *cover, metric);
  return prepared;
}

}  // namespace

std::vector<absl::StatusOr<LightMatrix>> FitLights(const Readback& readback,
                                                   absl::Span<const Light> lights,
                                                   MapSize map,
                                                   const FitOptions& options) {
  std::vector<absl::StatusOr<LightMatrix>> results(lights.size());
  absl::Status status = ValidateFitOptions(options);
  if (status.ok()) status = ValidateMap(map, options.margin_texels);
  uint32_t light_mask = 0;
  std::vector<absl::Status> light_status;
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
  return std::move(FitLights(readback, {light}, map, options).front());
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
  return std::move(prepared->summary);
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
  return FitInputs({light, summary}, map, options);
}

}  // namespace lightfit
