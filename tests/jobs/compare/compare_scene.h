// tests/jobs/compare/compare_scene.h
//
// A small scene for comparisons: a floor with boxes on it, seen from above its edge.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/camera.h"
#include "scenes/scene.h"

namespace lightfit {

inline void AddBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high, Scene* scene) {
  const int first = static_cast<int>(scene->vertices.size());
  for (int corner = 0; corner < 8; ++corner) {
    scene->vertices.emplace_back(static_cast<float>(corner & 1 ? high.x() : low.x()),
                                 static_cast<float>(corner & 2 ? high.y() : low.y()),
                                 static_cast<float>(corner & 4 ? high.z() : low.z()));
  }
  constexpr int kFaces[6][4] = {
      {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const int* face : kFaces) {
    scene->triangles.emplace_back(first + face[0], first + face[1], first + face[2]);
    scene->triangles.emplace_back(first + face[0], first + face[2], first + face[3]);
  }
}

// Y is up. The floor reaches 10 to every side, at y = 0.
inline Scene BoxesOnFloor() {
  Scene scene;
  scene.vertices = {{-10, 0, -10}, {10, 0, -10}, {10, 0, 10}, {-10, 0, 10}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  AddBox({-3, 0, 2}, {-2, 2.5, 3}, &scene);
  AddBox({1, 0, 4}, {1.6, 1, 4.6}, &scene);
  AddBox({2, 0, -5}, {4, 3, -4}, &scene);
  AddBox({-6, 0, -8}, {-5, 4, -7}, &scene);
  return scene;
}

inline constexpr char kBoxesCamera[] = "0,2,11:0,0.5,0:60";

inline Camera BoxesCamera(int width, int height) {
  return *LookAtCamera({0, 2, 11}, {0, 0.5, 0}, {0, 1, 0}, M_PI / 3, width, height);
}

// The text of a Wavefront file.
inline std::string ToObj(const Scene& scene) {
  std::string text;
  for (const Eigen::Vector3f& vertex : scene.vertices) {
    absl::StrAppend(&text, "v ", vertex.x(), " ", vertex.y(), " ", vertex.z(), "\n");
  }
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    absl::StrAppend(
        &text, "f ", triangle.x() + 1, " ", triangle.y() + 1, " ", triangle.z() + 1, "\n");
  }
  return text;
}

}  // namespace lightfit
