// geometry/octagon.h
//
// Tells quickly that points cannot be vertices of a convex hull.
// In:   points.
// Out:  whether others lie inside the octagon of the points furthest in eight directions
//       (Akl & Toussaint 1978).
#pragma once

#include <Eigen/Core>
#include <array>

#include "geometry/polygon.h"

namespace lightfit {

class Octagon {
 public:
  // Until it reaches to the point.
  void Stretch(const Eigen::Vector2d& point) {
    if (is_empty_) corner_.fill(point);
    is_empty_ = false;
    const double x = point.x(), y = point.y();
    if (y < corner_[0].y()) corner_[0] = point;
    if (x - y > corner_[1].x() - corner_[1].y()) corner_[1] = point;
    if (x > corner_[2].x()) corner_[2] = point;
    if (x + y > corner_[3].x() + corner_[3].y()) corner_[3] = point;
    if (y > corner_[4].y()) corner_[4] = point;
    if (y - x > corner_[5].y() - corner_[5].x()) corner_[5] = point;
    if (x < corner_[6].x()) corner_[6] = point;
    if (x + y < corner_[7].x() + corner_[7].y()) corner_[7] = point;
  }

 private:
  friend class OctagonInterior;

  bool is_empty_ = true;
  // Furthest towards -y, +x-y, +x, +x+y, +y, -x+y, -x, -x-y: counter-clockwise.
  std::array<Eigen::Vector2d, 8> corner_;
};

// Of the octagon as it is now.
class OctagonInterior {
 public:
  explicit OctagonInterior(const Octagon& octagon) {
    if (octagon.is_empty_) return;
    // Sides of no length hold nothing back: every point is "not left of" them.
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector2d along = octagon.corner_[(i + 1) % 8] - octagon.corner_[i];
      if (along == Eigen::Vector2d::Zero()) continue;
      corner_[num_sides_] = octagon.corner_[i];
      side_[num_sides_++] = along;
    }
  }

  // Strictly, so that the point is no vertex of the hull.
  bool operator()(const Eigen::Vector2d& point) const {
    bool left_of_all = num_sides_ >= 3;
    for (int i = 0; i < num_sides_; ++i) left_of_all &= Cross(side_[i], point - corner_[i]) > 0.0;
    return left_of_all;
  }

 private:
  std::array<Eigen::Vector2d, 8> corner_, side_;  // where the sides begin, and go
  int num_sides_ = 0;
};

}  // namespace lightfit
