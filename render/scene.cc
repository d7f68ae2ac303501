#include "render/scene.h"

#include <algorithm>

namespace lightfit {

namespace {

// The ray caster leaves out what lies beyond, and squares of coordinates overflow.
constexpr float kMaxCoordinate = 1e18F;

}  // namespace

Eigen::AlignedBox3d BoundsOf(const Scene& scene) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    for (const int vertex : triangle) bounds.extend(scene.vertices[vertex].cast<double>());
  }
  return bounds;
}

int64_t DropBadTriangles(Scene* scene) {
  const auto is_bad = [scene](const Eigen::Vector3i& triangle) {
    const auto num_vertices = static_cast<int64_t>(scene->vertices.size());
    for (const int vertex : triangle) {
      if (vertex < 0 || vertex >= num_vertices ||
          !(scene->vertices[vertex].cwiseAbs().maxCoeff() <= kMaxCoordinate) ||
          !scene->vertices[vertex].allFinite()) {
        return true;
      }
    }
    const Eigen::Vector3d a = scene->vertices[triangle[0]].cast<double>();
    const Eigen::Vector3d b = scene->vertices[triangle[1]].cast<double>() - a;
    const Eigen::Vector3d c = scene->vertices[triangle[2]].cast<double>() - a;
    return b.cross(c).squaredNorm() == 0.0;
  };
  const auto end = std::remove_if(scene->triangles.begin(), scene->triangles.end(), is_bad);
  const int64_t num_dropped = scene->triangles.end() - end;
  scene->triangles.erase(end, scene->triangles.end());
  return num_dropped;
}

}  // namespace lightfit
