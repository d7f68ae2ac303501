// render/scene.h
//
// The geometry of a scene: triangles and nothing else.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace lightfit {

// Both sides of a triangle are there; winding means nothing.
struct Scene {
  std::vector<Eigen::Vector3f> vertices;   // world units
  std::vector<Eigen::Vector3i> triangles;  // indices into `vertices`
};

// The box around all vertices that a triangle uses; empty (isEmpty()) without any.
Eigen::AlignedBox3d BoundsOf(const Scene& scene);

// Drops triangles without area, that repeat a vertex, or that have a vertex that is not finite,
// beyond 1e18, or not there. Returns how many.
int64_t DropBadTriangles(Scene* scene);

}  // namespace lightfit
