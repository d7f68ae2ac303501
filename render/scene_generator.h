// render/scene_generator.h
//
// A scene made by rule: tessellated objects on or near a floor, as in Chong & Gortler 3.
// In:   a seed and sizes.
// Out:  the same Scene on every machine.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "render/scene.h"

namespace lightfit {

struct SceneGeneratorOptions {
  uint64_t seed = 1;
  int num_objects = 40;               // spheres, tori, boxes, cylinders, cones, knots ...; >= 1
  int64_t num_triangles = 1'100'000;  // about; the floor's two among them. >= 100 per object
  double floor_half_size = 20.0;      // world units; y is up, the floor is at y = 0
};

absl::StatusOr<Scene> GenerateScene(const SceneGeneratorOptions& options);

}  // namespace lightfit
