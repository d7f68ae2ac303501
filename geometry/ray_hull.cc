#include "geometry/ray_hull.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/exact_sum.h"

namespace lightfit {

namespace {

using Rays = std::vector<Eigen::Vector3d>;

bool LexicographicallyLess(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// Three of the rays that do not lie in one plane, counter-clockwise, or none. Of each direction the
// first in the list is taken.
Rays FirstCone(const Rays& rays) {
  for (size_t j = 1; j < rays.size(); ++j) {
    for (size_t k = j + 1; k < rays.size(); ++k) {
      const int side = OrientationOfRays(rays[0], rays[j], rays[k]);
      if (side > 0) return {rays[0], rays[j], rays[k]};
      if (side < 0) return {rays[0], rays[k], rays[j]};
    }
  }
  return {};
}

// Adds a ray to a cone with at least three extreme rays. False when they surround the origin then.
bool AddRay(const Eigen::Vector3d& ray, Rays* cone) {
  const size_t count = cone->size();
  // On which side of each face (from ray i to the next) it lies.
  std::vector<int> sides(count);
  for (size_t i = 0; i < count; ++i) {
    sides[i] = OrientationOfRays((*cone)[i], (*cone)[(i + 1) % count], ray);
  }
  const bool outside = std::any_of(sides.begin(), sides.end(), [](int s) { return s < 0; });
  if (!outside) return true;
  // Its opposite is in the cone.
  if (std::all_of(sides.begin(), sides.end(), [](int s) { return s <= 0; })) return false;
  // The faces that stay are consecutive; the new ray goes between the last and the first of them.
  size_t first = 0;
  while (!(sides[first] > 0 && sides[(first + count - 1) % count] <= 0)) ++first;
  Rays grown = {ray};
  size_t i = first;
  do {
    grown.push_back((*cone)[i % count]);
  } while (sides[i++ % count] > 0);
  *cone = std::move(grown);
  return true;
}

}  // namespace

std::optional<Rays> ExtremeRays(Rays rays) {
  for (Eigen::Vector3d& ray : rays) ray.array() += 0.0;  // -0 becomes 0, or equal rays differ
  std::sort(rays.begin(), rays.end(), LexicographicallyLess);
  rays.erase(std::unique(rays.begin(), rays.end()), rays.end());
  Rays cone = FirstCone(rays);
  if (cone.empty()) return rays;
  for (const Eigen::Vector3d& ray : rays) {
    if (!AddRay(ray, &cone)) return std::nullopt;
  }
  const auto smallest = std::min_element(cone.begin(), cone.end(), LexicographicallyLess);
  std::rotate(cone.begin(), smallest, cone.end());
  return cone;
}

}  // namespace lightfit
