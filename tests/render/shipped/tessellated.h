// tests/render/shipped/tessellated.h
//
// Casters as finely tessellated as a rasteriser needs them for a pair of paraboloids.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "partition/shipped/paraboloid_edges.h"
#include "render/clearance.h"
#include "scenes/scene.h"

namespace lightfit::testing {

// Every edge in so many parts. A point on an edge is the same for both of the edge's triangles.
inline void AddParts(std::array<Eigen::Vector3d, 3> corners, int parts, Scene* scene) {
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  const auto begin = static_cast<int>(scene->vertices.size());
  const auto index_of = [begin](int row, int column) {
    return begin + row * (row + 1) / 2 + column;
  };
  for (int row = 0; row <= parts; ++row) {
    for (int column = 0; column <= row; ++column) {
      // Weights of the three corners: whole numbers over `parts`.
      const std::array<int, 3> weights = {parts - row, row - column, column};
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) point += weights[k] * corners[k] / parts;
      scene->vertices.push_back(point.cast<float>());
    }
  }
  for (int row = 0; row < parts; ++row) {
    for (int column = 0; column <= row; ++column) {
      scene->triangles.emplace_back(
          index_of(row, column), index_of(row + 1, column), index_of(row + 1, column + 1));
      if (column == row) continue;
      scene->triangles.emplace_back(
          index_of(row, column), index_of(row + 1, column + 1), index_of(row, column + 1));
    }
  }
}

// Each triangle by its own longest edge and distance from the light: between two neighbours that
// are cut unlike each other a gap of at most `max_error_texels` may be drawn.
inline Scene Tessellated(const Scene& scene,
                         const Eigen::Vector3d& light,
                         int size,
                         double max_error_texels) {
  Scene fine;
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = scene.vertices[triangle[k]].cast<double>();
    const double longest = std::max({(corners[0] - corners[1]).norm(),
                                     (corners[1] - corners[2]).norm(),
                                     (corners[2] - corners[0]).norm()});
    const double distance = DistanceToTriangle(light, corners[0], corners[1], corners[2]);
    AddParts(corners, EdgeParts(longest, distance, size, max_error_texels), &fine);
  }
  return fine;
}

}  // namespace lightfit::testing
