#include "optimizer/polish.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace lightfit {

namespace {

// Axis parameters (a, b) are of order one: the rays fill a square of side 2.
constexpr double kFirstStep = 0.02;
constexpr double kLastStep = 2e-5;
// Two steps in a row that gain less than this share of the energy end the descent.
constexpr double kQuickGain = 1e-3;
constexpr double kThoroughGain = 1e-5;
constexpr int kMaxSteps = 40;
constexpr int kMaxTrials = 12;  // per line search
// Weak Wolfe conditions: enough decrease, and a slope that has risen enough.
constexpr double kDecreaseShare = 1e-4;
constexpr double kSlopeShare = 0.5;
// At the end, axes on a circle of this radius are tried; a gain starts the descent anew.
constexpr double kProbeRadius = 2e-3;
constexpr int kNumProbes = 7;
constexpr double kProbeGain = 1e-4;
constexpr int kMaxDescents = 4;

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
                                const Point& from,
                                const Eigen::Vector2d& direction) {
  const double slope = from.gradient.dot(direction);
  double low = 0.0, high = std::numeric_limits<double>::infinity(), step = 1.0;
  std::optional<Point> best;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
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
    if (step * direction.norm() < kLastStep) break;
  }
  return best;
}

Point Descend(const ReducedEnergyCost& cost, double gain_tolerance, Point point) {
  Eigen::Matrix2d inverse_hessian = Eigen::Matrix2d::Zero();
  int num_small_gains = 0;
  for (int step = 0; step < kMaxSteps && num_small_gains < 2; ++step) {
    const double slope_norm = point.gradient.norm();
    if (!(slope_norm > 0.0)) break;
    Eigen::Vector2d direction = -inverse_hessian * point.gradient;
    if (!(direction.dot(point.gradient) < 0.0)) {
      inverse_hessian = kFirstStep / slope_norm * Eigen::Matrix2d::Identity();
      direction = -inverse_hessian * point.gradient;
    }
    std::optional<Point> next = LineSearch(cost, point, direction);
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
    num_small_gains = gain < gain_tolerance * point.fit.energy ? num_small_gains + 1 : 0;
    point = *std::move(next);
  }
  return point;
}

// The best of a few axes around, if it is better.
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

}  // namespace

RefineResult PolishAxis(const Summary& summary,
                        const AffineProblem& problem,
                        double min_w,
                        Polish polish,
                        const AffineFit& start) {
  RefineResult result;
  result.fit = start;
  const ReducedEnergyCost cost(summary, problem, min_w, start.energy);
  std::optional<Point> point = PointAt(cost, AxisParameters(start));
  for (int descent = 0; descent < kMaxDescents && point.has_value(); ++descent) {
    const double gain_tolerance = polish == Polish::kQuick ? kQuickGain : kThoroughGain;
    const Point reached = Descend(cost, gain_tolerance, *std::move(point));
    if (reached.fit.energy < result.fit.energy) result.fit = reached.fit;
    if (polish == Polish::kQuick) break;
    point = ProbeAround(cost, reached);
    if (point.has_value() && point->fit.energy < result.fit.energy) result.fit = point->fit;
  }
  result.evaluations = cost.num_evaluations();
  return result;
}

}  // namespace lightfit
