// tests/partition/published/degenerate_input.h
//
// Where all goes wrong at once: flat boxes, aligned lights, lights at the eye and among receivers,
// views without perspective.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "partition/plan.h"
#include "partition/published/storage_factor.h"
#include "tests/methods/random_input.h"

namespace lightfit::testing {

inline MethodInput DegenerateInput(Random& random) {
  MethodInput input = RandomInput(random);
  input.map = {random.Int(100, 1000), random.Int(100, 1000)};
  const Eigen::Vector3d eye = EyePosition(input.camera), view = ViewDirection(input.camera);
  const int flat_axis = random.Int(0, 5);
  if (flat_axis < 3) input.receivers.min()(flat_axis) = input.receivers.max()(flat_axis);
  if (flat_axis == 4) input.receivers.min() = input.receivers.max();
  const int kind = random.Int(0, 9);
  if (kind == 0) input.light = Light::Directional("sun", view);
  if (kind == 1) input.light = Light::Directional("sun", -view);
  if (kind == 2) input.light = Light::Point("lamp", eye);
  if (kind == 3) input.light = Light::Point("lamp", eye - random.Uniform(0.0, 1.0) * view);
  if (kind == 4) input.light = Light::Point("lamp", input.receivers.center());
  if (kind == 5) input.light = Light::Point("lamp", input.receivers.max());
  if (kind == 6) input.light = Light::Directional("sun", Eigen::Vector3d::Unit(random.Int(0, 2)));
  if (kind == 7) input.light = Light::Point("lamp", eye + input.camera.far * view);
  if (kind == 8) {
    // Along an edge of the view.
    input.light = Light::Directional("sun", FrustumCorners(input.camera)[5] - eye);
  }
  if (kind == 9) {
    input.camera.orthographic = true;
    input.camera.screen_from_camera(0, 0) = 20.0 / input.camera.near;
    input.camera.screen_from_camera(1, 1) = 20.0 / input.camera.near;
  }
  return input;
}

inline void ExpectFinite(const Plan& plan, const MethodInput& input) {
  for (const PlanMap& map : plan.maps) {
    EXPECT_TRUE(map.map_from_world.allFinite());
    for (const auto& half_space : map.half_spaces) EXPECT_TRUE(half_space.allFinite());
  }
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, input.light);
  EXPECT_TRUE(look_up.ok()) << look_up.status();
  const absl::StatusOr<double> storage = StorageFactor(plan, input);
  EXPECT_TRUE(storage.ok()) << storage.status();
  if (storage.ok()) {
    EXPECT_TRUE(std::isfinite(*storage));
  }
}

}  // namespace lightfit::testing
