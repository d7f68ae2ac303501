#include "partition/shipped/paraboloid_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "partition/shipped/paraboloid.h"

namespace lightfit {

double ChordError(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d plane = from.cross(to);
  const double length = plane.norm();
  if (!(length > 0.0)) return 0.0;
  const double curvature = std::abs(plane.z()) / length;  // 1 / R
  const double half_chord =
      0.5 * (ParaboloidFromDirection(to) - ParaboloidFromDirection(from)).norm();
  // R - sqrt(R^2 - h^2) without the difference of two large numbers.
  const double sine = std::min(curvature * half_chord, 1.0);
  return half_chord * sine / (1.0 + std::sqrt(1.0 - sine * sine));
}

double WidestEdge(int size, double max_error_texels) {
  return std::min(std::sqrt(16.0 * max_error_texels / size), M_PI);
}

double EdgeAngleBound(double length, double distance) {
  return 2.0 * std::atan2(0.5 * length, distance);
}

int EdgeParts(double longest_edge, double distance, int size, double max_error_texels) {
  const double widest = WidestEdge(size, max_error_texels);
  // The longest part that is seen at that angle.
  const double part = 2.0 * distance * std::tan(0.5 * widest);
  if (!(longest_edge > part)) return 1;
  return static_cast<int>(std::min(std::ceil(longest_edge / part), double{kMostEdgeParts}));
}

}  // namespace lightfit
