#include "partition/published/trapezoid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/convex_hull.h"
#include "geometry/polygon.h"

namespace lightfit {

namespace {

// The tightest of a slope.
Trapezoid TightAround(const Polygon& hull, double slope, double length) {
  double high = -std::numeric_limits<double>::infinity(), low = -high;
  for (const Eigen::Vector2d& point : hull) {
    high = std::max(high, point.x() - slope * point.y());
    low = std::min(low, point.x() + slope * point.y());
  }
  // The points where b = 0 lie between the legs there, but for rounding.
  return {0.5 * (low + high), std::max(high - low, 0.0), slope, length};
}

}  // namespace

Trapezoid LeastTrapezoid(absl::Span<const Eigen::Vector2d> points) {
  const Polygon hull = ConvexHull(points);
  double length = 0.0;
  for (const Eigen::Vector2d& point : hull) length = std::max(length, point.y());
  Trapezoid least = TightAround(hull, 0.0, length);
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d edge = hull[i + 1 == hull.size() ? 0 : i + 1] - hull[i];
    const double slope = std::abs(edge.x() / edge.y());
    if (!std::isfinite(slope)) continue;
    const Trapezoid trapezoid = TightAround(hull, slope, length);
    if (trapezoid.Area() < least.Area()) least = trapezoid;
  }
  return least;
}

}  // namespace lightfit
