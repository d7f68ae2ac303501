#include "optimizer/search/global_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/scratch.h"
#include "base/stop.h"
#include "optimizer/search/polish.h"
#include "optimizer/search/refine.h"

namespace lightfit {

namespace {

// How far out on a spoke candidates lie, as shares of the way to the polygon's edge. w falls to one
// minus this share on the ray that matters, so steps even out in the logarithm of the warp.
constexpr double kSpokeShares[] = {0.4, 0.75, 0.93};
// Candidates that are refined, and how far apart they must be in (a, b).
constexpr int kNumRefined = 3;
constexpr double kMinDistance = 0.25;
// A candidate this much above the best is not worth refining.
constexpr double kRefinedFactor = 2.0;
// Nor is one this much above the best worth polishing once refined.
constexpr double kPolishedFactor = 1.2;

// How far from the origin the polar polygon's edge is in a direction.
double DistanceToEdge(const Polygon& hull, double min_w, const Eigen::Vector2d& direction) {
  double steepest = 0.0;
  for (const Eigen::Vector2d& ray : hull) steepest = std::max(steepest, -direction.dot(ray));
  return (1.0 - min_w) / steepest;
}

// The best candidates, best first, no two close together.
ScratchVector<AffineFit> SelectCandidates(const ScratchVector<AffineFit>& candidates) {
  // Of equals the first; std::stable_sort would allocate.
  ScratchVector<int> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::pair(candidates[a].energy, a) < std::pair(candidates[b].energy, b);
  });
  ScratchVector<AffineFit> selected;
  for (const int index : order) {
    const AffineFit& candidate = candidates[index];
    if (selected.size() == kNumRefined ||
        candidate.energy > kRefinedFactor * candidates[order[0]].energy) {
      break;
    }
    const bool is_apart =
        std::all_of(selected.begin(), selected.end(), [&](const AffineFit& other) {
          return (AxisParameters(candidate) - AxisParameters(other)).norm() >= kMinDistance;
        });
    if (is_apart) selected.push_back(candidate);
  }
  return selected;
}

}  // namespace

SearchResult GlobalSearch(const Summary& summary,
                          AxisEvaluator& evaluator,
                          const AffineFit& start,
                          int grid_directions,
                          Refiner refiner) {
  SearchResult result;
  result.report.energy_start = start.energy;
  result.report.trace.push_back({"start", evaluator.num_evaluations(), start.energy});

  ScratchVector<AffineFit> candidates = {start};
  const auto consider = [&](const Eigen::Vector2d& ab) {
    const std::optional<AffineFit> fit = evaluator.Evaluate(ab.homogeneous());
    if (fit.has_value()) candidates.push_back(*fit);
  };
  consider(Eigen::Vector2d::Zero());
  for (int spoke = 0; spoke < grid_directions && !StopRequested(); ++spoke) {
    const double angle = 2.0 * M_PI * spoke / grid_directions;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const double edge = DistanceToEdge(summary.cover.hull, evaluator.min_w(), direction);
    for (const double share : kSpokeShares) consider(share * edge * direction);
  }
  candidates = SelectCandidates(candidates);
  result.fit = candidates.front();
  result.report.trace.push_back({"grid", evaluator.num_evaluations(), result.fit.energy});

  int evaluations = evaluator.num_evaluations();
  ScratchVector<AffineFit> refined_fits;
  for (const AffineFit& candidate : candidates) {
    SearchResult refined =
        RefineAxis(summary, evaluator.problem(), evaluator.min_w(), refiner, candidate);
    evaluations += refined.report.evaluations;
    std::string& solver_report = result.report.solver_report;
    if (refined.fit.energy < result.fit.energy || solver_report.empty()) {
      solver_report = std::move(refined.report.solver_report);
    }
    if (refined.fit.energy < result.fit.energy) result.fit = refined.fit;
    refined_fits.push_back(refined.fit);
  }
  result.report.trace.push_back({"refine", evaluations, result.fit.energy});

  const auto polish = [&](Polish thoroughness, const AffineFit& fit) {
    const SearchResult polished =
        PolishAxis(summary, evaluator.problem(), evaluator.min_w(), thoroughness, fit);
    evaluations += polished.report.evaluations;
    if (polished.fit.energy < result.fit.energy) result.fit = polished.fit;
  };
  // What is far behind after Ceres does not catch up.
  const double limit = kPolishedFactor * result.fit.energy;
  for (const AffineFit& fit : refined_fits) {
    if (fit.energy <= limit && refined_fits.size() > 1) polish(Polish::kQuick, fit);
  }
  polish(Polish::kThorough, AffineFit(result.fit));
  result.report.trace.push_back({"polish", evaluations, result.fit.energy});
  result.report.evaluations = evaluations;
  return result;
}

}  // namespace lightfit
