// fuzz/promise_scene.h
//
// What a reader of scenes owes.
// In:   a scene or an error.
// Out:  nothing; a broken promise ends the program (fuzz/promises.h).
#pragma once

#include <utility>

#include "absl/status/statusor.h"
#include "fuzz/promises.h"
#include "scenes/scene.h"

namespace lightfit::fuzz {

inline void PromiseScene(absl::StatusOr<Scene> scene) {
  PromiseOkOrError(scene.status());
  if (!scene.ok()) return;
  DropBadTriangles(&*scene);
  for (const Eigen::Vector3i& triangle : scene->triangles) {
    Promise(
        triangle.minCoeff() >= 0 && triangle.maxCoeff() < static_cast<int>(scene->vertices.size()),
        "the corners of good triangles are there");
  }
  Promise(scene->triangles.empty() || BoundsOf(*scene).sizes().allFinite(),
          "good triangles have finite corners");
}

}  // namespace lightfit::fuzz
