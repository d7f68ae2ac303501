#include "geometry/convex_hull.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace lightfit {

namespace {

// Above this many points it pays to throw away most of the inner ones before sorting.
constexpr size_t kFilterFrom = 32;

// The points without those strictly inside the octagon of the points furthest in eight directions
// (Akl & Toussaint 1978). None of them can be a vertex of the hull.
ScratchVector<Eigen::Vector2d> WithoutInnerPoints(absl::Span<const Eigen::Vector2d> points) {
  // Furthest towards -y, +x-y, +x, +x+y, +y, -x+y, -x, -x-y: counter-clockwise.
  std::array<Eigen::Vector2d, 8> corner;
  corner.fill(points.front());
  for (const Eigen::Vector2d& point : points) {
    const double x = point.x(), y = point.y();
    if (y < corner[0].y()) corner[0] = point;
    if (x - y > corner[1].x() - corner[1].y()) corner[1] = point;
    if (x > corner[2].x()) corner[2] = point;
    if (x + y > corner[3].x() + corner[3].y()) corner[3] = point;
    if (y > corner[4].y()) corner[4] = point;
    if (y - x > corner[5].y() - corner[5].x()) corner[5] = point;
    if (x < corner[6].x()) corner[6] = point;
    if (x + y < corner[7].x() + corner[7].y()) corner[7] = point;
  }
  // Sides of no length hold nothing back: every point is "not left of" them.
  std::array<Eigen::Vector2d, 8> side;
  int num_sides = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d along = corner[(i + 1) % 8] - corner[i];
    if (along == Eigen::Vector2d::Zero()) continue;
    corner[num_sides] = corner[i];
    side[num_sides++] = along;
  }
  const auto inside = [&](const Eigen::Vector2d& point) {
    bool left_of_all = num_sides >= 3;
    for (int i = 0; i < num_sides; ++i) left_of_all &= Cross(side[i], point - corner[i]) > 0.0;
    return left_of_all;
  };
  ScratchVector<Eigen::Vector2d> outer;
  std::remove_copy_if(points.begin(), points.end(), std::back_inserter(outer), inside);
  return outer;
}

}  // namespace

Polygon ConvexHull(absl::Span<const Eigen::Vector2d> points) {
  using Points = ScratchVector<Eigen::Vector2d>;
  Points sorted = points.size() > kFilterFrom ? WithoutInnerPoints(points)
                                              : Points(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;

  // Lower chain from left to right, then upper chain back.
  Polygon hull;
  hull.reserve(32);
  const auto add = [&hull](const Eigen::Vector2d& point, size_t fixed) {
    while (hull.size() >= fixed + 2 &&
           Cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Eigen::Vector2d& point : sorted) add(point, 0);
  const size_t lower = hull.size() - 1;
  for (auto point = sorted.rbegin() + 1; point != sorted.rend(); ++point) add(*point, lower);
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
