// render/generator/scene_generator.h
//
// A scene made by rule: tessellated objects on or near a floor, as in Chong & Gortler 3; or a
// furnished room with windows, render/generator/room.h.
// In:   a seed and sizes.
// Out:  the same Scene on every machine.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "scenes/scene.h"

namespace lightfit {

enum class SceneKind { kFloor, kRoom };

struct SceneGeneratorOptions {
  SceneKind kind = SceneKind::kFloor;
  uint64_t seed = 1;
  int64_t num_triangles = 1'100'000;  // about. Of a floor >= 100 per object, of a room >= 20'000

  // Of a floor alone; y is up, the floor is at y = 0.
  int num_objects = 40;           // spheres, tori, boxes, cylinders, cones, knots ...; >= 1
  double floor_half_size = 20.0;  // world units
};

absl::StatusOr<Scene> GenerateScene(const SceneGeneratorOptions& options);

}  // namespace lightfit
