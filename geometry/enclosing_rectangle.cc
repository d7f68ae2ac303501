#include "geometry/enclosing_rectangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace lightfit {

namespace {

// A degenerate polygon's rectangle: the segment between its ends, with no height.
Parallelogram SegmentRectangle(const Polygon& polygon) {
  Parallelogram rectangle;
  if (polygon.empty()) return rectangle;
  rectangle.corner = polygon.front();
  rectangle.edge_u = polygon.back() - polygon.front();
  return rectangle;
}

// The smallest k (in size) that shears x + k y so that vertices overhanging the base [0, base] to
// one side come back over it without leaving on the other. 0 where they overhang both or neither.
double ShearOverBase(const Polygon& polygon,
                     const Eigen::Vector2d& origin,
                     const Eigen::Vector2d& along,
                     double base) {
  double low = 0.0, high = base;  // extents in x of the vertices off the base
  double shear_left_home = 0.0;   // brings every vertex to x >= 0
  double shear_right_home = 0.0;  // brings every vertex to x <= base
  double room_right = std::numeric_limits<double>::infinity();
  double room_left = -std::numeric_limits<double>::infinity();
  bool any = false;
  for (const Eigen::Vector2d& vertex : polygon) {
    const double x = along.dot(vertex - origin);
    const double y = Cross(along, vertex - origin);
    if (y <= 1e-12 * base) continue;
    low = any ? std::min(low, x) : x;
    high = any ? std::max(high, x) : x;
    any = true;
    shear_left_home = std::max(shear_left_home, -x / y);
    shear_right_home = std::min(shear_right_home, (base - x) / y);
    room_right = std::min(room_right, (base - x) / y);
    room_left = std::max(room_left, -x / y);
  }
  if (!any) return 0.0;
  if (low < 0.0 && high < base) return std::min(shear_left_home, room_right);
  if (low > 0.0 && high > base) return std::max(shear_right_home, room_left);
  return 0.0;
}

template <bool kSkew>
Parallelogram SmallestOverEdges(const Polygon& polygon) {
  const size_t n = polygon.size();
  if (n < 3) return SegmentRectangle(polygon);
  Parallelogram best;
  double best_area = std::numeric_limits<double>::infinity();
  // Calipers: indices of the vertices furthest along the edge, furthest from it, furthest back.
  size_t ahead = 1, apart = 1, behind = 1;
  const auto next = [n](size_t i) { return i + 1 == n ? 0 : i + 1; };
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d edge = polygon[next(i)] - polygon[i];
    const Eigen::Vector2d along = edge.normalized();
    const Eigen::Vector2d away = Perpendicular(along);
    if (i == 0) ahead = next(i);
    while (along.dot(polygon[next(ahead)] - polygon[ahead]) > 0.0) ahead = next(ahead);
    if (i == 0) apart = ahead;
    while (away.dot(polygon[next(apart)] - polygon[apart]) > 0.0) apart = next(apart);
    if (i == 0) behind = apart;
    while (along.dot(polygon[next(behind)] - polygon[behind]) < 0.0) behind = next(behind);

    double x_min = along.dot(polygon[behind] - polygon[i]);
    double x_max = along.dot(polygon[ahead] - polygon[i]);
    const double height = away.dot(polygon[apart] - polygon[i]);
    double shear = 0.0;
    if constexpr (kSkew) {
      shear = ShearOverBase(polygon, polygon[i], along, edge.norm());
      if (shear != 0.0) {
        x_min = std::numeric_limits<double>::infinity();
        x_max = -x_min;
        for (const Eigen::Vector2d& vertex : polygon) {
          const Eigen::Vector2d offset = vertex - polygon[i];
          const double x = along.dot(offset) + shear * away.dot(offset);
          x_min = std::min(x_min, x);
          x_max = std::max(x_max, x);
        }
      }
    }
    const double area = (x_max - x_min) * height;
    if (area < best_area) {
      best_area = area;
      best.corner = polygon[i] + along * x_min;
      best.edge_u = along * (x_max - x_min);
      best.edge_v = (away - shear * along) * height;
    }
  }
  return best;
}

}  // namespace

Parallelogram MinAreaRectangle(const Polygon& polygon) { return SmallestOverEdges<false>(polygon); }

Parallelogram MinAreaSkewedRectangle(const Polygon& polygon) {
  return SmallestOverEdges<true>(polygon);
}

}  // namespace lightfit
