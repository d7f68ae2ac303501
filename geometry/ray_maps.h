// geometry/ray_maps.h
//
// Several maps of one light's rays, and which of them is the densest at a ray.
// In:   homographies from rays to texels, sizes; a ray.
// Out:  RayMap; DensestAt().   math.md (18), (20)
#pragma once

#include <Eigen/Core>
#include <limits>

#include "absl/types/span.h"

namespace lightfit {

struct RayMap {
  RayMap(const Eigen::Matrix3d& map_from_ray, double width, double height);

  Eigen::Matrix3d map_from_ray;  // (u w, v w, w), texels
  double width, height;          // texels, whole or not

  // q = coarseness . X, math.md (18): 1 / (texels per area)^(1/3) up to what all maps have in
  // common. It does not depend on the scale of the homography.
  Eigen::Vector3d coarseness;

  // Whether the ray is in front and in the rectangle, `guard_texels` from its sides.
  bool Holds(const Eigen::Vector3d& ray, double guard_texels = 0.0) const {
    const Eigen::Vector3d at = map_from_ray * ray;
    const double low = guard_texels * at.z();
    return at.z() > 0.0 && at.x() >= low && at.y() >= low && at.x() < width * at.z() - low &&
           at.y() < height * at.z() - low;
  }
};

// Of the maps k with askable(k) and q_k > 0 that of least q_k, of equals the first; -1: none.
template <typename Askable>
int DensestAt(absl::Span<const RayMap> maps, const Eigen::Vector3d& ray, const Askable& askable) {
  int densest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < maps.size(); ++k) {
    const double q = maps[k].coarseness.dot(ray);
    if (!(q > 0.0 && q < least) || !askable(static_cast<int>(k))) continue;
    least = q;
    densest = static_cast<int>(k);
  }
  return densest;
}

// Of those that hold the ray, `guard_texels` from their sides.   math.md (20)
inline int DensestAt(absl::Span<const RayMap> maps,
                     const Eigen::Vector3d& ray,
                     double guard_texels = 0.0) {
  return DensestAt(maps, ray, [&](int k) { return maps[k].Holds(ray, guard_texels); });
}

}  // namespace lightfit
