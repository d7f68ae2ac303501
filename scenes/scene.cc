#include "scenes/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lightfit {

namespace {

// The ray caster leaves out what lies beyond, and squares of coordinates overflow.
constexpr float kMaxCoordinate = 1e18F;

// Of the scene's half diagonal: how far from zero its middle must be for the origin to move. A
// float then still has 21 bits for the scene itself.
constexpr double kFarFromZero = 4.0;

// A multiple of a power of two, so that the difference to a float out there is one too.
double OriginOf(double middle, double half_diagonal) {
  if (!(std::abs(middle) > kFarFromZero * half_diagonal)) return 0.0;
  const double step = std::exp2(std::floor(std::log2(half_diagonal)));
  const double origin = std::round(middle / step) * step;
  return std::isfinite(origin) ? origin : 0.0;
}

}  // namespace

Scene MakeScene(const std::vector<Eigen::Vector3d>& vertices,
                std::vector<Eigen::Vector3i> triangles) {
  Scene scene;
  const auto num_vertices = static_cast<int64_t>(vertices.size());
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3i& triangle : triangles) {
    for (const int vertex : triangle) {
      if (vertex >= 0 && vertex < num_vertices &&
          vertices[vertex].cwiseAbs().maxCoeff() <= kMaxCoordinate &&
          vertices[vertex].allFinite()) {
        bounds.extend(vertices[vertex]);
      }
    }
  }
  if (!bounds.isEmpty()) {
    const double half_diagonal = 0.5 * bounds.diagonal().norm();
    for (int axis = 0; axis < 3; ++axis) {
      scene.origin[axis] = OriginOf(bounds.center()[axis], half_diagonal);
    }
  }
  scene.vertices.reserve(vertices.size());
  for (const Eigen::Vector3d& vertex : vertices) {
    scene.vertices.emplace_back((vertex - scene.origin).cast<float>());
  }
  scene.triangles = std::move(triangles);
  return scene;
}

Eigen::AlignedBox3d BoundsOf(const Scene& scene) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    for (const int vertex : triangle) bounds.extend(scene.WorldOf(vertex));
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
