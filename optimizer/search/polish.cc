#include "optimizer/search/polish.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lightfit {

namespace {

// Axis parameters (a, b) are of order one: the rays fill a square of side 2.
constexpr double kFirstStep = 0.02;
// Weak Wolfe conditions: enough decrease, and a slope that has risen enough.
constexpr double kDecreaseShare = 1e-4;
constexpr double kSlopeShare = 0.5;
constexpr int kNumProbes = 7;

constexpr double kProbeRadius = 2e-3;
constexpr double kProbeGain = 1e-4;

// How far a descent goes.
struct Effort {
  double last_step;  // line searches end there
  double gain;       // two steps in a row that gain less than this share of the energy end it
  int max_steps;
  int max_trials;  // per line search
};
constexpr Effort kQuickEffort = {2e-5, 1e-3, 40, 12};
constexpr Effort kThoroughEffort = {2e-5, 1e-5, 40, 12};
constexpr Effort kExactEffort = {1e-12, 1e-13, 100, 40};
constexpr int kMaxDescents = 4;

// The exact search: sides of the squares around the best axis so far, and steps by the golden
// section each way.
constexpr double kFirstSide = 4e-3, kLastSide = 4e-8;
constexpr int kGoldenSteps = 24;
constexpr int kMaxSquares = 64;  // a handful do, unless the energy is that of damaged sums

struct Point {
  Eigen::Vector2d ab;
  AffineFit fit;
  Eigen::Vector2d gradient;
};

std::optional<Point> PointAt(const ReducedEnergyCost& cost, const Eigen::Vector2d& ab) {
  std::optional<AffineFit> fit = cost.FitAt(ab);
  if (!fit.has_value()) return std::nullopt;
  const Eigen::Vector2d gradient = cost.GradientAt(*fit);
  if (!gradient.allFinite()) return std::nullopt;
  return Point{ab, *std::move(fit), gradient};
}

// A point along `direction` that fulfils the weak Wolfe conditions, or the best seen with less
// energy, or nothing. Axes that cannot be used count as too far.
std::optional<Point> LineSearch(const ReducedEnergyCost& cost,
                                const Effort& effort,
                                const Point& from,
                                const Eigen::Vector2d& direction) {
  const double slope = from.gradient.dot(direction);
  double low = 0.0, high = std::numeric_limits<double>::infinity(), step = 1.0;
  std::optional<Point> best;
  for (int trial = 0; trial < effort.max_trials; ++trial) {
    std::optional<Point> point = PointAt(cost, from.ab + step * direction);
    if (!point.has_value() || point->fit.energy > from.fit.energy + kDecreaseShare * step * slope) {
      high = step;
    } else {
      const bool risen = point->gradient.dot(direction) >= kSlopeShare * slope;
      if (!best.has_value() || point->fit.energy < best->fit.energy) best = std::move(point);
      if (risen) break;
      low = step;
    }
    step = std::isfinite(high) ? 0.5 * (low + high) : 2.0 * step;
    if (step * direction.norm() < effort.last_step) break;
  }
  return best;
}

Point Descend(const ReducedEnergyCost& cost, const Effort& effort, Point point) {
  Eigen::Matrix2d inverse_hessian = Eigen::Matrix2d::Zero();
  int num_small_gains = 0;
  for (int step = 0; step < effort.max_steps && num_small_gains < 2; ++step) {
    const double slope_norm = point.gradient.norm();
    if (!(slope_norm > 0.0)) break;
    Eigen::Vector2d direction = -inverse_hessian * point.gradient;
    if (!(direction.dot(point.gradient) < 0.0)) {
      inverse_hessian = kFirstStep / slope_norm * Eigen::Matrix2d::Identity();
      direction = -inverse_hessian * point.gradient;
    }
    std::optional<Point> next = LineSearch(cost, effort, point, direction);
    if (!next.has_value()) break;
    const Eigen::Vector2d moved = next->ab - point.ab;
    const Eigen::Vector2d turned = next->gradient - point.gradient;
    const double curvature = moved.dot(turned);
    if (curvature > 0.0) {  // the BFGS update of the inverse
      const Eigen::Matrix2d project =
          Eigen::Matrix2d::Identity() - moved * turned.transpose() / curvature;
      inverse_hessian =
          project * inverse_hessian * project.transpose() + moved * moved.transpose() / curvature;
    }
    const double gain = point.fit.energy - next->fit.energy;
    num_small_gains = gain < effort.gain * point.fit.energy ? num_small_gains + 1 : 0;
    point = *std::move(next);
  }
  return point;
}

// The best of a few axes around, if it is better. At the end of a descent a gain starts a new one.
std::optional<Point> ProbeAround(const ReducedEnergyCost& cost, const Point& centre) {
  std::optional<Point> best;
  double limit = centre.fit.energy * (1.0 - kProbeGain);
  for (int i = 0; i < kNumProbes; ++i) {
    const double angle = 2.0 * M_PI * i / kNumProbes;
    const Eigen::Vector2d ab =
        centre.ab + kProbeRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    std::optional<AffineFit> fit = cost.FitAt(ab);
    if (!fit.has_value() || !(fit->energy < limit)) continue;
    limit = fit->energy;
    best = Point{ab, *std::move(fit), Eigen::Vector2d::Zero()};
  }
  if (best.has_value()) best->gradient = cost.GradientAt(best->fit);
  return best;
}

// The argument in low ... high with the least value, by the golden section.
template <typename Function>
double GoldenSection(double low, double high, const Function& value_at) {
  const double kShare = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - kShare * (high - low), right = low + kShare * (high - low);
  double left_value = value_at(left), right_value = value_at(right);
  for (int step = 0; step < kGoldenSteps; ++step) {
    if (left_value <= right_value) {
      high = right;
      right = left;
      right_value = left_value;
      left = high - kShare * (high - low);
      left_value = value_at(left);
    } else {
      low = left;
      left = right;
      left_value = right_value;
      right = low + kShare * (high - low);
      right_value = value_at(right);
    }
  }
  return left_value <= right_value ? left : right;
}

// Descents stall in creases that are narrow: hardly any direction leads down. A golden section over
// b within one over a finds the bottom of each slice across them; in ever smaller squares.
AffineFit SearchSquaresAround(const ReducedEnergyCost& cost, AffineFit best) {
  const auto energy_at = [&](double a, double b) {
    std::optional<AffineFit> fit = cost.FitAt({a, b});
    if (!fit.has_value()) return std::numeric_limits<double>::infinity();
    const double energy = fit->energy;
    if (energy < best.energy) best = *std::move(fit);
    return energy;
  };
  double side = kFirstSide;
  for (int square = 0; square < kMaxSquares && side >= kLastSide; ++square) {
    const Eigen::Vector2d centre = AxisParameters(best);
    const double before = best.energy;
    GoldenSection(centre.x() - 0.5 * side, centre.x() + 0.5 * side, [&](double a) {
      const double b = GoldenSection(centre.y() - 0.5 * side,
                                     centre.y() + 0.5 * side,
                                     [&](double b) { return energy_at(a, b); });
      return energy_at(a, b);
    });
    // The optimum may lie beyond the square: go on from where its border is lowest.
    const double moved = (AxisParameters(best) - centre).lpNorm<Eigen::Infinity>();
    if (moved < 0.4 * side || before - best.energy < kExactEffort.gain * before) side *= 0.01;
  }
  return best;
}

}  // namespace

SearchResult PolishAxis(const Summary& summary,
                        const AffineProblem& problem,
                        double min_w,
                        Polish polish,
                        const AffineFit& start) {
  SearchResult result;
  result.fit = start;
  const ReducedEnergyCost cost(summary, problem, min_w, start.energy);
  const Effort& effort = polish == Polish::kQuick      ? kQuickEffort
                         : polish == Polish::kThorough ? kThoroughEffort
                                                       : kExactEffort;
  std::optional<Point> point = PointAt(cost, AxisParameters(start));
  for (int descent = 0; descent < kMaxDescents && point.has_value(); ++descent) {
    const Point reached = Descend(cost, effort, *std::move(point));
    if (reached.fit.energy < result.fit.energy) result.fit = reached.fit;
    if (polish == Polish::kQuick) break;
    point = ProbeAround(cost, reached);
    if (point.has_value() && point->fit.energy < result.fit.energy) result.fit = point->fit;
  }
  if (polish == Polish::kExact) result.fit = SearchSquaresAround(cost, result.fit);
  result.report.evaluations = cost.num_evaluations();
  return result;
}

}  // namespace lightfit
