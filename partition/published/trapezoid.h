// partition/published/trapezoid.h
//
// The isosceles trapezoid of least area around points of the plane, its axis along y.
// In:   points (a, b), 0 <= b.
// Out:  Trapezoid {centre, base, slope, length}.   published_plans.md (T1)
//
//        ____            b = 0, as wide as the base
//       /    \.
//      /      \.         |a - centre| <= base / 2 + slope b
//     /________\         b = length
#pragma once

#include <Eigen/Core>

#include "absl/types/span.h"

namespace lightfit {

struct Trapezoid {
  double centre = 0.0;  // a of the axis
  double base = 0.0;    // n, the width where b = 0
  double slope = 0.0;   // tan(theta) >= 0, theta between the axis and a leg
  double length = 0.0;  // L

  double WidthAt(double b) const { return base + 2.0 * slope * b; }
  double Area() const { return length * (base + slope * length); }
};

// Over all bases, slopes and axes: a linear program. For a slope t the legs touch the points at
// max(a - t b) and min(a + t b), so that the area over the length, base(t) + t length, is convex
// and piecewise linear in t. Its least value lies at t = 0 or where a leg lies along an edge of the
// points' hull, so those are all there is to try. The base may come out as 0. Requires a point.
Trapezoid LeastTrapezoid(absl::Span<const Eigen::Vector2d> points);

}  // namespace lightfit
