#include "optimizer/search/axis_search.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/scratch.h"
#include "base/stop.h"
#include "optimizer/energy/l1_weights.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/global_search.h"
#include "optimizer/search/polish.h"
#include "optimizer/search/refine.h"

namespace lightfit {

namespace {

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
                                            const SearchOptions& options) {
  const AffineProblem problem = MakeAffineProblem(summary, map, options);
  std::optional<SampleEvaluator> by_samples;
  std::optional<SummaryEvaluator> by_summary;
  AxisEvaluator* evaluator = nullptr;
  if (options.sample_by_sample && inputs.samples != nullptr && inputs.receivers != nullptr) {
    evaluator = &by_samples.emplace(
        *inputs.samples, *inputs.receivers, summary.metric, problem, options.min_w);
  } else {
    evaluator = &by_summary.emplace(summary, problem, options.min_w);
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

// Whether the options ask for more than what is published.
bool Polishes(const SearchOptions& options) {
  return options.search == Search::kGlobal || options.search == Search::kRotationLineSearchRefined;
}

// SearchInputs::to_the_end.
void PolishExactly(const Summary& summary,
                   MapSize map,
                   const SearchOptions& options,
                   SearchOutcome* outcome) {
  const AffineProblem problem = MakeAffineProblem(summary, map, options);
  RefineResult polished =
      PolishAxis(summary, problem, options.min_w, Polish::kExact, outcome->result.fit);
  outcome->result.fit = polished.fit;
  outcome->evaluations += polished.evaluations;
  outcome->result.trace.push_back({"exact", outcome->evaluations, polished.fit.energy});
}

// Where the search began, judged by the sum of footprints.
absl::StatusOr<SearchOutcome> StartOfL1(const SearchInputs& inputs,
                                        MapSize map,
                                        const SearchOptions& options) {
  SearchOptions focused = options;
  focused.search = Search::kFocused;
  absl::StatusOr<SearchOutcome> start = SearchSquares(inputs, inputs.summary, map, focused);
  if (!start.ok()) return start.status();
  AffineFit& fit = start->result.fit;
  fit.energy = WeightsForL1(*inputs.samples, inputs.summary.metric, fit.map_from_ray)
                   .footprint_sum;
  start->energy_start = fit.energy;
  start->result.trace = {{"start", start->evaluations, fit.energy}};
  return start;
}

// L1 by iteratively reweighted least squares: a sample's squared footprint weighs as much as one
// over its footprint in the round before, so that the weighted squares sum to the footprints. The
// first round searches as the options say; the axis then moves little, so that the global and the
// refined search only polish it in the rounds that follow.
absl::StatusOr<SearchOutcome> SearchL1(const SearchInputs& inputs,
                                       MapSize map,
                                       const SearchOptions& options) {
  absl::StatusOr<SearchOutcome> best = StartOfL1(inputs, map, options);
  if (!best.ok()) return best.status();
  ScratchVector<TraceStep> trace = best->result.trace;
  const double energy_start = best->energy_start;
  int evaluations = best->evaluations;
  Samples reweighted = *inputs.samples;
  SearchOutcome current = *best;
  for (int round = 0; round < options.reweighting_rounds; ++round) {
    if (StopRequested()) break;
    const Summary summary =
        SummarizeSamples(reweighted, inputs.summary.cover, inputs.summary.metric);
    if (round > 0 && Polishes(options)) {
      const AffineProblem problem = MakeAffineProblem(summary, map, options);
      SummaryEvaluator evaluator(summary, problem, options.min_w);
      const std::optional<AffineFit> start =
          evaluator.Evaluate(current.result.fit.map_from_ray.row(2).transpose());
      if (!start.has_value()) break;
      const bool is_last = round + 1 == options.reweighting_rounds;
      RefineResult polished = PolishAxis(
          summary, problem, options.min_w, is_last ? Polish::kThorough : Polish::kQuick, *start);
      current.result.fit = polished.fit;
      evaluations += 1 + polished.evaluations;
    } else {
      const SearchInputs round_inputs = {inputs.light, summary, &reweighted, inputs.receivers};
      absl::StatusOr<SearchOutcome> outcome = SearchSquares(round_inputs, summary, map, options);
      if (!outcome.ok()) return outcome.status();
      current = *std::move(outcome);
      evaluations += current.evaluations;
    }
    if (StopRequested()) break;
    L1Weights l1 = WeightsForL1(
        *inputs.samples, inputs.summary.metric, current.result.fit.map_from_ray);
    trace.push_back({round == 0 ? "search" : "reweight", evaluations, l1.footprint_sum});
    if (l1.footprint_sum < best->result.fit.energy) {
      best = current;
      best->result.fit.energy = l1.footprint_sum;
    }
    reweighted.weight = std::move(l1.weights);
  }
  best->energy_start = energy_start;
  best->evaluations = evaluations;
  best->result.trace = std::move(trace);
  return best;
}

// The energies of a search on weighted squares as bounds of the sum of footprints.
SearchOutcome AsFootprintSums(SearchOutcome outcome, double footprint_sum) {
  const auto convert = [footprint_sum](double* energy) {
    *energy = std::sqrt(*energy * footprint_sum);
  };
  convert(&outcome.result.fit.energy);
  convert(&outcome.energy_start);
  for (TraceStep& step : outcome.result.trace) convert(&step.energy);
  return outcome;
}

absl::StatusOr<SearchOutcome> SearchInMetric(const SearchInputs& inputs,
                                             MapSize map,
                                             const SearchOptions& options) {
  const bool is_l1 = IsL1(options.metric) && inputs.summary.counts.used > 0;
  if (is_l1 && inputs.samples != nullptr) return SearchL1(inputs, map, options);
  absl::StatusOr<SearchOutcome> outcome = SearchSquares(inputs, inputs.summary, map, options);
  if (!outcome.ok()) return outcome;
  if (inputs.to_the_end && Polishes(options)) {
    PolishExactly(inputs.summary, map, options, &*outcome);
  }
  if (!is_l1) return outcome;
  return AsFootprintSums(*std::move(outcome), inputs.summary.footprint_sum);
}

}  // namespace

AffineProblem MakeAffineProblem(const Summary& summary, MapSize map, const SearchOptions& options) {
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

absl::StatusOr<SearchOutcome> SearchAxis(const SearchInputs& inputs,
                                         MapSize map,
                                         const SearchOptions& options) {
  absl::StatusOr<SearchOutcome> outcome = SearchInMetric(inputs, map, options);
  // Whatever it is, it may be that because no more axes could be used.
  if (absl::Status status = CheckStop(inputs.light); !status.ok()) return status;
  return outcome;
}

}  // namespace lightfit
