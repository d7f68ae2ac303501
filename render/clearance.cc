#include "render/clearance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <vector>

namespace lightfit {

namespace {

double SquaredDistanceToEdge(const Eigen::Vector3d& point,
                             const Eigen::Vector3d& a,
                             const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp(along.dot(point - a) / length, 0.0, 1.0) : 0.0;
  return (point - a - share * along).squaredNorm();
}

}  // namespace

double DistanceToTriangle(const Eigen::Vector3d& point,
                          const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b,
                          const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  if (area > 0.0) {
    // Above the inside of all three edges the plane is nearest.
    const double above_ab = normal.dot((b - a).cross(point - a));
    const double above_bc = normal.dot((c - b).cross(point - b));
    const double above_ca = normal.dot((a - c).cross(point - c));
    if (above_ab >= 0.0 && above_bc >= 0.0 && above_ca >= 0.0) {
      return std::abs(normal.dot(point - a)) / std::sqrt(area);
    }
  }
  return std::sqrt(std::min({SquaredDistanceToEdge(point, a, b),
                             SquaredDistanceToEdge(point, b, c),
                             SquaredDistanceToEdge(point, c, a)}));
}

double Clearance(const RayCaster& caster, const Eigen::Vector3d& point) {
  constexpr int kChunk = 8192;
  const Scene& scene = caster.scene();
  const auto count = static_cast<int>(scene.triangles.size());
  std::vector<double> nearest((count + kChunk - 1) / kChunk,
                              std::numeric_limits<double>::infinity());
  ParallelFor(count, kChunk, caster.num_threads(), [&](int begin, int end) {
    double& least = nearest[begin / kChunk];
    for (int i = begin; i < end; ++i) {
      const Eigen::Vector3i& corners = scene.triangles[i];
      least = std::min(least,
                       DistanceToTriangle(point,
                                          scene.WorldOf(corners[0]),
                                          scene.WorldOf(corners[1]),
                                          scene.WorldOf(corners[2])));
    }
  });
  return *std::min_element(nearest.begin(), nearest.end());
}

}  // namespace lightfit
