// geometry/hull_interior.h
//
// Tells quickly that points lie inside a convex polygon.
// In:   a counter-clockwise convex polygon, then any number of points.
// Out:  true only for points inside; a few close to the edge are missed.
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/polygon.h"

namespace lightfit {

// A convex polygon cut into slabs of equal width across one axis, each with the range of the other
// coordinate that is inside over its whole width. Points near the edge are not recognised.
class Slabs {
 public:
  // Slabs across x for `across` = 0, across y for 1.
  Slabs(const Polygon& polygon, int across);

  bool Contain(const Eigen::Vector2d& point) const {
    const double slab = (point(across_) - begin_) * slabs_per_unit_;
    if (!(slab >= 0.0 && slab < kNumSlabs)) return false;
    const int index = static_cast<int>(slab);
    return point(1 - across_) > low_[index] && point(1 - across_) < high_[index];
  }

 private:
  static constexpr int kNumSlabs = 64;

  int across_;
  double begin_ = 0.0;
  double slabs_per_unit_ = 0.0;
  std::array<double, kNumSlabs> low_, high_;
};

// Slabs both ways: where one cuts the edge at a steep angle the other does not.
class HullInterior {
 public:
  explicit HullInterior(const Polygon& polygon) : across_x_(polygon, 0), across_y_(polygon, 1) {}

  bool operator()(const Eigen::Vector2d& point) const {
    return across_x_.Contain(point) || across_y_.Contain(point);
  }

 private:
  Slabs across_x_, across_y_;
};

}  // namespace lightfit
