#include "geometry/convex_hull.h"

#include <algorithm>

namespace lightfit {

Polygon ConvexHull(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;

  // Lower chain from left to right, then upper chain back.
  Polygon hull;
  hull.reserve(64);
  const auto add = [&hull](const Eigen::Vector2d& point, size_t fixed) {
    while (hull.size() >= fixed + 2 &&
           Cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Eigen::Vector2d& point : points) add(point, 0);
  const size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) add(*point, lower);
  hull.pop_back();  // the first point again
  return hull;
}

double Area(const Polygon& polygon) {
  double twice_area = 0.0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    twice_area += Cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return 0.5 * twice_area;
}

Eigen::Vector2d Centroid(const Polygon& polygon) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  if (polygon.empty()) return sum;
  double twice_area = 0.0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i - 1] - polygon[0];
    const Eigen::Vector2d b = polygon[i] - polygon[0];
    twice_area += Cross(a, b);
    sum += Cross(a, b) * (a + b) / 3.0;
  }
  if (twice_area > 0.0) return polygon[0] + sum / twice_area;
  for (const Eigen::Vector2d& vertex : polygon) sum += vertex;
  return sum / static_cast<double>(polygon.size());
}

}  // namespace lightfit
