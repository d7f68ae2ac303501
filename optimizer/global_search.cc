#include "optimizer/global_search.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace lightfit {

namespace {

// How far out on a spoke candidates lie, as shares of the way to the polygon's edge. w falls to one
// minus this share on the ray that matters, so steps even out in the logarithm of the warp.
constexpr double kSpokeShares[] = {0.4, 0.75, 0.93};
// Refinements that are started, from the best candidates.
constexpr int kNumRefined = 2;
// The compass search starts with steps of this share of the way to the edge ...
constexpr double kPolishStep = 0.02;
// ... and ends at this one.
constexpr double kPolishStepEnd = 5e-4;

Eigen::Vector2d AxisParameters(const AffineFit& fit) {
  return fit.map_from_ray.row(2).head<2>().transpose() / fit.map_from_ray(2, 2);
}

// How far from the origin the polar polygon's edge is in a direction.
double DistanceToEdge(const Polygon& hull, double min_w, const Eigen::Vector2d& direction) {
  double steepest = 0.0;
  for (const Eigen::Vector2d& ray : hull) steepest = std::max(steepest, -direction.dot(ray));
  return (1.0 - min_w) / steepest;
}

}  // namespace

AffineFit PolishAxis(AxisEvaluator& evaluator, const AffineFit& start) {
  AffineFit best = start;
  Eigen::Vector2d last_move = Eigen::Vector2d::Zero();
  for (double step = kPolishStep; step >= kPolishStepEnd;) {
    const Eigen::Vector2d here = AxisParameters(best);
    std::vector<Eigen::Vector2d> moves = {{step, 0.0}, {-step, 0.0}, {0.0, step}, {0.0, -step}};
    if (last_move != Eigen::Vector2d::Zero()) moves.insert(moves.begin(), last_move);
    bool improved = false;
    for (const Eigen::Vector2d& move : moves) {
      const std::optional<AffineFit> fit = evaluator.Evaluate((here + move).homogeneous());
      if (!fit.has_value() || !(fit->energy < best.energy)) continue;
      improved = fit->energy < best.energy * (1.0 - 1e-5);
      best = *fit;
      last_move = move;
      break;
    }
    if (!improved) {
      step *= 0.5;
      last_move.setZero();
    }
  }
  return best;
}

SearchResult GlobalSearch(const Summary& summary,
                          AxisEvaluator& evaluator,
                          const AffineFit& start,
                          int grid_directions,
                          Refiner refiner,
                          std::string* solver_report) {
  SearchResult result;
  result.trace.push_back({"start", evaluator.num_evaluations(), start.energy});

  std::vector<AffineFit> candidates = {start};
  const auto consider = [&](const Eigen::Vector2d& ab) {
    const std::optional<AffineFit> fit = evaluator.Evaluate(ab.homogeneous());
    if (fit.has_value()) candidates.push_back(*fit);
  };
  consider(Eigen::Vector2d::Zero());
  for (int spoke = 0; spoke < grid_directions; ++spoke) {
    const double angle = 2.0 * M_PI * spoke / grid_directions;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const double edge = DistanceToEdge(summary.cover.hull, evaluator.min_w(), direction);
    for (const double share : kSpokeShares) consider(share * edge * direction);
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.energy < b.energy;
  });
  result.fit = candidates.front();
  result.trace.push_back({"grid", evaluator.num_evaluations(), result.fit.energy});

  int refine_evaluations = 0;
  const int num_refined = std::min<int>(kNumRefined, static_cast<int>(candidates.size()));
  for (int i = 0; i < num_refined; ++i) {
    RefineResult refined = RefineAxis(
        summary, evaluator.problem(), evaluator.min_w(), refiner, candidates[i]);
    refine_evaluations += refined.evaluations;
    if (refined.fit.energy < result.fit.energy || (i == 0 && !refined.report.empty())) {
      *solver_report = refined.report;
    }
    if (refined.fit.energy < result.fit.energy) result.fit = refined.fit;
  }
  result.trace.push_back(
      {"refine", evaluator.num_evaluations() + refine_evaluations, result.fit.energy});

  result.fit = PolishAxis(evaluator, result.fit);
  result.trace.push_back(
      {"polish", evaluator.num_evaluations() + refine_evaluations, result.fit.energy});
  return result;
}

}  // namespace lightfit
