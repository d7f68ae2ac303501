#include "optimizer/axis_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "optimizer/axis_evaluator.h"
#include "optimizer/global_search.h"
#include "optimizer/polish.h"
#include "optimizer/refine.h"

namespace lightfit {

namespace {

// Keeps reweighted samples of vanishing footprint from weighing everything: a share of the mean.
constexpr double kReweightingFloor = 1e-3;

bool IsL1(Metric metric) { return metric == Metric::kL1 || metric == Metric::kL1AcrossEdge; }

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

absl::StatusOr<SearchOutcome> SearchSquares(const SearchInputs& inputs,
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
absl::StatusOr<SearchOutcome> SearchL1(const SearchInputs& inputs,
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
    SearchInputs round_inputs = {inputs.light, summary, &reweighted, inputs.receivers};
    absl::StatusOr<SearchOutcome> outcome = SearchSquares(round_inputs, summary, map, options);
    if (!outcome.ok()) return outcome.status();
    evaluations += outcome->evaluations;
    if (round == 0) {
      FitOptions focused = options;
      focused.search = Search::kFocused;
      absl::StatusOr<SearchOutcome> start =
          SearchSquares(round_inputs, inputs.summary, map, focused);
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

}  // namespace

absl::StatusOr<SearchOutcome> SearchAxis(const SearchInputs& inputs,
                                         MapSize map,
                                         const FitOptions& options) {
  return IsL1(options.metric) && inputs.summary.counts.used > 0
             ? SearchL1(inputs, map, options)
             : SearchSquares(inputs, inputs.summary, map, options);
}

}  // namespace lightfit
