// geometry/polygon.h
//
// Convex polygons and parallelograms in the plane: the shapes that fitting works with.
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"

namespace lightfit {

// Vertices of a convex polygon, counter-clockwise (x right, y up), none repeated. Fewer than three
// vertices mean a point or a segment.
using Polygon = ScratchVector<Eigen::Vector2d>;

// The points corner + s edge_u + t edge_v, 0 <= s, t <= 1.
struct Parallelogram {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();
  Eigen::Vector2d edge_u = Eigen::Vector2d::Zero();
  Eigen::Vector2d edge_v = Eigen::Vector2d::Zero();
};

inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Counter-clockwise by a right angle.
inline Eigen::Vector2d Perpendicular(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

inline double Area(const Parallelogram& p) { return std::abs(Cross(p.edge_u, p.edge_v)); }

}  // namespace lightfit
