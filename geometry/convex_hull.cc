#include "geometry/convex_hull.h"

#include <algorithm>
#include <iterator>

namespace lightfit {

namespace {

// Above this many points it pays to throw away most of the inner ones before sorting.
constexpr size_t kFilterFrom = 32;

// The points without most of those that cannot be vertices of the hull.
ScratchVector<Eigen::Vector2d> WithoutInnerPoints(absl::Span<const Eigen::Vector2d> points) {
  Octagon octagon;
  for (const Eigen::Vector2d& point : points) octagon.Stretch(point);
  ScratchVector<Eigen::Vector2d> outer;
  std::remove_copy_if(
      points.begin(), points.end(), std::back_inserter(outer), OctagonInterior(octagon));
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

void ConvexHullBuilder::DropInnerPoints() {
  const OctagonInterior is_inner(octagon_);
  points_.erase(std::remove_if(points_.begin() + num_outer_, points_.end(), is_inner),
                points_.end());
  if (points_.size() >= most_outer_) {
    points_.erase(std::remove_if(points_.begin(), points_.end(), is_inner), points_.end());
    if (points_.size() >= most_outer_ / 2) points_ = ConvexHull(points_);
    most_outer_ = std::max(kMostOuter, 4 * points_.size());
  }
  num_outer_ = points_.size();
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
