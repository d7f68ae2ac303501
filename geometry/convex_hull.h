// geometry/convex_hull.h
//
// Convex hull of points in the plane.
// In:   finite points in any order, repeats allowed.
// Out:  a counter-clockwise Polygon of input points; collinear points are left out.
#pragma once

#include <Eigen/Core>

#include "absl/types/span.h"
#include "geometry/polygon.h"

namespace lightfit {

// Andrew's monotone chain, O(n log n). No points give no vertices, one or
// collinear points give one or two.
Polygon ConvexHull(absl::Span<const Eigen::Vector2d> points);

// Twice the area would be a cross product away; this is the area itself, positive for a
// counter-clockwise polygon.
double Area(const Polygon& polygon);

// Centre of mass of the polygon's area; of its vertices when it has none.
Eigen::Vector2d Centroid(const Polygon& polygon);

}  // namespace lightfit
