// scenes/scene.h
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
  std::vector<Eigen::Vector3f> vertices;   // world units, from `origin`
  std::vector<Eigen::Vector3i> triangles;  // indices into `vertices`

  // World. Other than zero where a scene lies so far out that a float would lose its details.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();

  // World position of a vertex.
  Eigen::Vector3d WorldOf(int vertex) const { return origin + vertices[vertex].cast<double>(); }
};

// From world positions in double precision. The origin moves along each axis on which the triangles
// lie several of their own sizes away from zero; what is stored of positions that were floats is
// then still exact.
Scene MakeScene(const std::vector<Eigen::Vector3d>& vertices,
                std::vector<Eigen::Vector3i> triangles);

// The box around all vertices that a triangle uses, world; empty (isEmpty()) without any.
Eigen::AlignedBox3d BoundsOf(const Scene& scene);

// Drops triangles without area, that repeat a vertex, or that have a vertex that is not finite,
// beyond 1e18, or not there. Returns how many.
int64_t DropBadTriangles(Scene* scene);

}  // namespace lightfit
