// tests/render/texel_verdict.h
//
// What a texel says of a receiver, by all hits on the ray through the texel's centre: brute force.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "render/surface_image.h"
#include "tests/render/testing.h"

namespace lightfit::testing {

// Not known where rounding decides.
struct Verdict {
  bool is_known = false, ideal = false, practical = false, practical_is_close = false;
};

// Near an edge of its texel a place may be in the one or the other.
inline bool IsOnATexelsEdge(const Eigen::Vector2d& place) {
  const Eigen::Vector2d whole = place.array().round();
  return (place - whole).cwiseAbs().minCoeff() < 1e-6;
}

inline Eigen::Vector2d CentreOfTexelAt(const Eigen::Vector2d& place) {
  return place.array().floor() + 0.5;
}

// The constant bias is a small share of the scene, about 20 units.
inline Verdict VerdictOf(const Scene& scene, const SurfacePoint& receiver, const Ray& ray) {
  const BruteHits hits = AllHits(scene, ray);
  const double slope = receiver.normal.dot(ray.direction);
  if (hits.near_an_edge || slope > -1e-2) return {};
  const double wanted = receiver.normal.dot(receiver.position - ray.origin) / slope;
  if (hits.distances.empty()) return {true, false, false};
  double nearest = hits.distances[0];
  for (const double hit : hits.distances) {
    if (std::abs(hit - wanted) < std::abs(nearest - wanted)) nearest = hit;
  }
  // The default's constant is at most 2e-4 of the scene.
  const double in_front = wanted - hits.distances[0];
  return {true, nearest > hits.distances[0] + 1e-4, in_front > 0.0, std::abs(in_front) < 0.02};
}

}  // namespace lightfit::testing
