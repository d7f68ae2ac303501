// tests/testing/shapes.h
//
// Independent figures of parallelograms around polygons, for the tests of the enclosing shapes.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "geometry/polygon.h"

namespace lightfit::testing {

// How far any vertex lies outside the parallelogram, as a share of its sides; <= 0 when all lie in.
inline double Overhang(const Parallelogram& shape, const Polygon& polygon) {
  Eigen::Matrix2d edges;
  edges << shape.edge_u, shape.edge_v;
  double overhang = -1.0;
  for (const Eigen::Vector2d& vertex : polygon) {
    const Eigen::Vector2d unit = edges.inverse() * (vertex - shape.corner);
    overhang = std::max({overhang, -unit.minCoeff(), unit.maxCoeff() - 1.0});
  }
  return overhang;
}

// The extent of the polygon along a direction.
inline double Extent(const Polygon& polygon, const Eigen::Vector2d& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector2d& vertex : polygon) {
    low = std::min(low, direction.dot(vertex));
    high = std::max(high, direction.dot(vertex));
  }
  return high - low;
}

// The least area of an enclosing rectangle with a side along some edge of the polygon.
inline double MinRectangleAreaOverEdges(const Polygon& polygon) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d along = (polygon[(i + 1) % polygon.size()] - polygon[i]).normalized();
    least = std::min(least, Extent(polygon, along) * Extent(polygon, Perpendicular(along)));
  }
  return least;
}

}  // namespace lightfit::testing
