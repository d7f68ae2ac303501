// geometry/convex_hull.h
//
// Convex hull of points in the plane.
// In:   finite points in any order, repeats allowed.
// Out:  a counter-clockwise Polygon of input points; collinear points are left out.
#pragma once

#include <Eigen/Core>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/octagon.h"
#include "geometry/polygon.h"

namespace lightfit {

// Andrew's monotone chain, O(n log n). No points give no vertices, one or
// collinear points give one or two.
Polygon ConvexHull(absl::Span<const Eigen::Vector2d> points);

// The same of points that come one by one and are too many to keep.
class ConvexHullBuilder {
 public:
  void Add(const Eigen::Vector2d& point) {
    octagon_.Stretch(point);
    points_.push_back(point);
    if (points_.size() == num_outer_ + kBlock) DropInnerPoints();
  }

  // Of all points so far.
  Polygon Hull() const { return ConvexHull(points_); }

 private:
  // Few enough to stay in the processor's cache and to be sorted within a millisecond.
  static constexpr size_t kBlock = 2048;
  static constexpr size_t kMostOuter = 8192;

  void DropInnerPoints();

  Octagon octagon_;
  ScratchVector<Eigen::Vector2d> points_;  // that may be vertices
  size_t num_outer_ = 0;                   // at the front: known to lie outside of the octagon
  size_t most_outer_ = kMostOuter;
};

// Twice the area would be a cross product away; this is the area itself, positive for a
// counter-clockwise polygon.
double Area(const Polygon& polygon);

// Centre of mass of the polygon's area; of its vertices when it has none.
Eigen::Vector2d Centroid(const Polygon& polygon);

}  // namespace lightfit
