// tests/render/testing.h
//
// Small scenes, and brute force for everything that casts rays: every triangle, in double
// precision.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "geometry/homography.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "render/ray_caster.h"
#include "render/surface_image.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/process.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

inline void AddTriangle(const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c,
                        Scene* scene) {
  const auto first = static_cast<int>(scene->vertices.size());
  for (const Eigen::Vector3d& corner : {a, b, c}) scene->vertices.push_back(corner.cast<float>());
  scene->triangles.emplace_back(first, first + 1, first + 2);
}

// The corners in order around it.
inline void AddQuad(const Eigen::Vector3d& a,
                    const Eigen::Vector3d& b,
                    const Eigen::Vector3d& c,
                    const Eigen::Vector3d& d,
                    Scene* scene) {
  AddTriangle(a, b, c, scene);
  AddTriangle(a, c, d, scene);
}

inline void AddBox(const Box& box, Scene* scene) {
  Eigen::Vector3d corner[8];
  const Eigen::AngleAxisd turn(box.turn_rad, Eigen::Vector3d::UnitZ());
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corner[i] = box.center + turn * Eigen::Vector3d(sign.cwiseProduct(box.half_size));
  }
  constexpr int kFaces[6][4] = {
      {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    AddQuad(corner[f[0]], corner[f[1]], corner[f[2]], corner[f[3]], scene);
  }
}

// The floor z = 0.
inline void AddFloor(double half_size, Scene* scene) {
  AddQuad({-half_size, -half_size, 0},
          {half_size, -half_size, 0},
          {half_size, half_size, 0},
          {-half_size, half_size, 0},
          scene);
}

inline Scene SceneOf(const BoxScene& boxes) {
  Scene scene;
  AddFloor(boxes.floor_half_size, &scene);
  for (const Box& box : boxes.boxes) AddBox(box, &scene);
  return scene;
}

inline Scene RandomTriangles(Random& random, int count, double size) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d middle = random.InCube(0.5 * size);
    const double extent = size * random.LogUniform(0.02, 0.5);
    AddTriangle(middle + random.InCube(extent),
                middle + random.InCube(extent),
                middle + random.InCube(extent),
                &scene);
  }
  return scene;
}

inline RayCaster Caster(Scene scene, int num_threads = 2) {
  absl::StatusOr<RayCaster> caster = RayCaster::Build(std::move(scene), num_threads);
  EXPECT_TRUE(caster.ok()) << caster.status();
  return *std::move(caster);
}

// FNV-1a over all bytes.
inline uint64_t HashOf(const Scene& scene) {
  uint64_t hash = 14695981039346656037ULL;
  const auto add = [&hash](const void* data, size_t num_bytes) {
    for (size_t i = 0; i < num_bytes; ++i) {
      hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211ULL;
    }
  };
  for (const Eigen::Vector3f& vertex : scene.vertices) add(vertex.data(), 3 * sizeof(float));
  for (const Eigen::Vector3i& triangle : scene.triangles) add(triangle.data(), 3 * sizeof(int));
  return hash;
}

struct BruteHits {
  std::vector<double> distances;  // ascending
  int first = -1;                 // triangle of the nearest
  bool near_an_edge = false;      // rounding decides about some triangle
};

// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
inline BruteHits AllHits(const Scene& scene, const Ray& ray) {
  constexpr double kEdge = 1e-4;  // of the triangle; single precision far from the origin
  BruteHits hits;
  double nearest = 1e300;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const Eigen::Vector3d a = scene.vertices[scene.triangles[i][0]].cast<double>();
    const Eigen::Vector3d e1 = scene.vertices[scene.triangles[i][1]].cast<double>() - a;
    const Eigen::Vector3d e2 = scene.vertices[scene.triangles[i][2]].cast<double>() - a;
    const Eigen::Vector3d p = ray.direction.cross(e2);
    const double determinant = e1.dot(p);
    if (std::abs(determinant) <= 1e-4 * e1.norm() * e2.norm()) {
      hits.near_an_edge = true;  // seen edge-on
      continue;
    }
    const Eigen::Vector3d to = ray.origin - a;
    const Eigen::Vector3d q = to.cross(e1);
    const double u = to.dot(p) / determinant, v = ray.direction.dot(q) / determinant;
    const double inside = std::min({u, v, 1.0 - u - v});
    const double distance = e2.dot(q) / determinant;
    if (distance > 0.0 && std::abs(inside) < kEdge) hits.near_an_edge = true;
    if (inside < 0.0 || !(distance > 0.0)) continue;
    hits.distances.push_back(distance);
    if (distance < nearest) {
      nearest = distance;
      hits.first = static_cast<int>(i);
    }
  }
  std::sort(hits.distances.begin(), hits.distances.end());
  return hits;
}

// A map of `size` around all surfaces of the image, seen along `forward` (point lights only).
inline Eigen::Matrix4d MapAround(const SurfaceImage& image,
                                 const Light& light,
                                 MapSize size,
                                 const Eigen::Vector3d& forward = -Eigen::Vector3d::UnitZ()) {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light, forward);
  Eigen::AlignedBox2d box;
  for (const SurfacePoint& pixel : image.pixels) {
    if (!pixel.is_surface()) continue;
    const Eigen::Vector3d X = ray_from_world * pixel.position.homogeneous();
    EXPECT_GT(X.z(), 0.0);
    box.extend(X.hnormalized());
  }
  const Eigen::Vector2d margin = 0.01 * box.sizes();
  const Eigen::Vector2d low = box.min() - margin, extent = box.sizes() + 2.0 * margin;
  Eigen::Matrix3d map_from_ray;
  map_from_ray << size.width / extent.x(), 0.0, -low.x() * size.width / extent.x(),  //
      0.0, size.height / extent.y(), -low.y() * size.height / extent.y(),            //
      0.0, 0.0, 1.0;
  return MapFromWorld(map_from_ray, ray_from_world, light, {1.0, 2.0}, 1.0);
}

// The scenes of the project's development set, beside the repository.
inline std::string SharedScene(const std::string& name) {
  return RepositoryPath("../shared/scenes/" + name + ".glb");
}

}  // namespace lightfit::testing
