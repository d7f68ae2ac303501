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
#include "optimizer/energy/reweighting.h"
#include "optimizer/search/axis_evaluator.h"
#include "optimizer/search/global_search.h"
#include "optimizer/search/line_search.h"
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

absl::StatusOr<SearchResult> SearchSquares(const SearchInputs& inputs,
                                           const Summary& summary,
                                           MapSize map,
                                           const SearchOptions& options) {
  const AffineProblem problem = MakeAffineProblem(summary, map, options);
  std::optional<SampleEvaluator> by_samples;
  std::optional<SummaryEvaluator> by_summary;
  AxisEvaluator* evaluator = nullptr;
  if (options.sample_by_sample && inputs.samples != nullptr && inputs.surfaces != nullptr) {
    evaluator = &by_samples.emplace(
        *inputs.samples, *inputs.surfaces, summary.metric, problem, options.min_w);
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
  switch (options.search) {
    case Search::kFocused: {
      SearchResult result;
      result.fit = *start;
      SearchReport& report = result.report;
      report.energy_start = start->energy;
      report.evaluations = evaluator->num_evaluations();
      report.trace.push_back({"start", report.evaluations, start->energy});
      report.stop_reason = StopReason::kNoSearch;
      return result;
    }
    case Search::kRotationLineSearch:
      return RotationLineSearch(*evaluator, *start, options.line_search_rounds);
    case Search::kRotationLineSearchRefined: {
      SearchResult result = RotationLineSearch(*evaluator, *start, options.line_search_rounds);
      SearchReport& report = result.report;
      SearchResult refined =
          RefineAxis(summary, problem, options.min_w, options.refiner, result.fit);
      report.evaluations += refined.report.evaluations;
      report.trace.push_back({"refine", report.evaluations, refined.fit.energy});
      const SearchResult polished =
          PolishAxis(summary, problem, options.min_w, Polish::kThorough, refined.fit);
      report.evaluations += polished.report.evaluations;
      report.trace.push_back({"polish", report.evaluations, polished.fit.energy});
      report.stop_reason = StopReason::kConverged;
      report.solver_report = std::move(refined.report.solver_report);
      result.fit = polished.fit;
      return result;
    }
    case Search::kGlobal:
      return GlobalSearch(summary, *evaluator, *start, options.grid_directions, options.refiner);
  }
  return absl::InvalidArgumentError("options.search: no such search");
}

// Whether the options ask for more than what is published.
bool Polishes(const SearchOptions& options) {
  return options.search == Search::kGlobal || options.search == Search::kRotationLineSearchRefined;
}

// SearchEffort::kToTheEnd.
void PolishExactly(const Summary& summary,
                   MapSize map,
                   const SearchOptions& options,
                   SearchResult* result) {
  const AffineProblem problem = MakeAffineProblem(summary, map, options);
  const SearchResult polished =
      PolishAxis(summary, problem, options.min_w, Polish::kExact, result->fit);
  result->fit = polished.fit;
  result->report.evaluations += polished.report.evaluations;
  result->report.trace.push_back({"exact", result->report.evaluations, polished.fit.energy});
}

// Where the search began, judged by the sum of footprints.
absl::StatusOr<SearchResult> StartOfL1(const SearchInputs& inputs,
                                       MapSize map,
                                       const SearchOptions& options) {
  SearchOptions focused = options;
  focused.search = Search::kFocused;
  absl::StatusOr<SearchResult> start = SearchSquares(inputs, inputs.summary, map, focused);
  if (!start.ok()) return start.status();
  AffineFit& fit = start->fit;
  fit.energy = WeightsForL1(*inputs.samples, inputs.summary.metric, fit.map_from_ray).footprint_sum;
  start->report.energy_start = fit.energy;
  start->report.trace = {{"start", start->report.evaluations, fit.energy}};
  return start;
}

// L1 by iteratively reweighted least squares: a sample's squared footprint weighs as much as one
// over its footprint in the round before, so that the weighted squares sum to the footprints. The
// first round searches as the options say; the axis then moves little, so that the global and the
// refined search only polish it in the rounds that follow.
absl::StatusOr<SearchResult> SearchL1(const SearchInputs& inputs,
                                      MapSize map,
                                      const SearchOptions& options) {
  absl::StatusOr<SearchResult> start = StartOfL1(inputs, map, options);
  if (!start.ok()) return start.status();
  SearchReport report = start->report;
  SearchResult current = *start;
  BestOfRounds<SearchResult> best;
  const double start_energy = start->fit.energy;
  best.Offer(start_energy, *std::move(start));
  Samples reweighted = *inputs.samples;
  for (int round = 0; round < options.reweighting_rounds; ++round) {
    if (StopRequested()) break;
    const Summary summary =
        SummarizeSamples(reweighted, inputs.summary.cover, inputs.summary.metric);
    if (round > 0 && Polishes(options)) {
      const AffineProblem problem = MakeAffineProblem(summary, map, options);
      SummaryEvaluator evaluator(summary, problem, options.min_w);
      const std::optional<AffineFit> from =
          evaluator.Evaluate(current.fit.map_from_ray.row(2).transpose());
      if (!from.has_value()) break;
      const bool is_last = round + 1 == options.reweighting_rounds;
      const SearchResult polished = PolishAxis(
          summary, problem, options.min_w, is_last ? Polish::kThorough : Polish::kQuick, *from);
      current.fit = polished.fit;
      report.evaluations += 1 + polished.report.evaluations;
    } else {
      const SearchInputs round_inputs = {inputs.light, summary, &reweighted, inputs.surfaces};
      absl::StatusOr<SearchResult> result = SearchSquares(round_inputs, summary, map, options);
      if (!result.ok()) return result.status();
      current = *std::move(result);
      report.evaluations += current.report.evaluations;
    }
    if (StopRequested()) break;
    L1Weights l1 = WeightsForL1(*inputs.samples, inputs.summary.metric, current.fit.map_from_ray);
    report.trace.push_back(
        {round == 0 ? "search" : "reweight", report.evaluations, l1.footprint_sum});
    SearchResult candidate = current;
    candidate.fit.energy = l1.footprint_sum;
    best.Offer(l1.footprint_sum, std::move(candidate));
    reweighted.weight = std::move(l1.weights);
  }
  SearchResult result = std::move(best).Best();
  report.stop_reason = result.report.stop_reason;
  report.solver_report = std::move(result.report.solver_report);
  result.report = std::move(report);
  return result;
}

// The energies of a search on weighted squares as bounds of the sum of footprints.
SearchResult AsFootprintSums(SearchResult result, double footprint_sum) {
  const auto convert = [footprint_sum](double* energy) {
    *energy = std::sqrt(*energy * footprint_sum);
  };
  convert(&result.fit.energy);
  convert(&result.report.energy_start);
  for (TraceStep& step : result.report.trace) convert(&step.energy);
  return result;
}

absl::StatusOr<SearchResult> SearchInMetric(const SearchInputs& inputs,
                                            MapSize map,
                                            const SearchOptions& options,
                                            SearchEffort effort) {
  const bool is_l1 = IsL1(options.metric) && inputs.summary.counts.used > 0;
  if (is_l1 && inputs.samples != nullptr) return SearchL1(inputs, map, options);
  absl::StatusOr<SearchResult> result = SearchSquares(inputs, inputs.summary, map, options);
  if (!result.ok()) return result;
  if (effort == SearchEffort::kToTheEnd && Polishes(options)) {
    PolishExactly(inputs.summary, map, options, &*result);
  }
  if (!is_l1) return result;
  return AsFootprintSums(*std::move(result), inputs.summary.footprint_sum);
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

absl::StatusOr<SearchResult> SearchAxis(const SearchInputs& inputs,
                                        MapSize map,
                                        const SearchOptions& options,
                                        SearchEffort effort) {
  absl::StatusOr<SearchResult> result = SearchInMetric(inputs, map, options, effort);
  // Whatever it is, it may be that because no more axes could be used.
  if (absl::Status status = CheckStop(inputs.light); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
