#include "geometry/polar_of_difference.h"

#include <algorithm>
#include <cmath>

namespace lightfit {

namespace {

// Edges count as parallel when the sine of their angle is below this.
constexpr double kParallelTolerance = 1e-12;

}  // namespace

ScratchVector<PolarBreakpoint> PolarOfDifference(const Polygon& points) {
  const int n = static_cast<int>(points.size());
  const auto next = [n](int i) { return i + 1 == n ? 0 : i + 1; };
  const auto edge = [&](int i) -> Eigen::Vector2d { return points[next(i)] - points[i]; };

  // Calipers: `low` starts an edge whose opposite vertex is `high`, the first of those furthest
  // away. Not found by comparing edge directions: neighbouring edges may be collinear to rounding.
  const auto distance = [&](int i) { return Cross(edge(0), points[i] - points[0]); };
  double furthest = 0.0;
  for (int i = 2; i < n; ++i) furthest = std::max(furthest, distance(i));
  int low = 0, high = 2;
  while (high + 1 < n && distance(high) < furthest * (1.0 - kParallelTolerance)) ++high;

  ScratchVector<PolarBreakpoint> polar;
  polar.reserve(n);
  const auto parallel = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::abs(Cross(a, b)) <= kParallelTolerance * a.norm() * b.norm();
  };
  // Together `low` and `high` pass n edges while the strip turns by half a turn.
  for (int passed = 0; passed < n; ++passed) {
    // The strip turns counter-clockwise; it next lies along the edge at `low` or that at `high`.
    const Eigen::Vector2d edge_low = edge(low);
    const Eigen::Vector2d edge_high = -edge(high);
    const bool pass_low = Cross(edge_low, edge_high) >= 0.0;
    const Eigen::Vector2d normal = Perpendicular(pass_low ? edge_low : edge_high);
    const double width = normal.dot(points[high] - points[low]);
    (pass_low ? low : high) = next(pass_low ? low : high);
    // Edges in one direction share a breakpoint, or rounding would make false valleys of them.
    if (polar.empty() || !parallel(polar.back().row, normal)) {
      polar.push_back({normal / width, Eigen::Vector2d::Zero(), low, high});
    }
    polar.back().low = low;
    polar.back().high = high;
    polar.back().pair = points[high] - points[low];
  }
  if (polar.size() > 2 && parallel(polar.back().row, polar.front().row)) polar.pop_back();
  return polar;
}

}  // namespace lightfit
