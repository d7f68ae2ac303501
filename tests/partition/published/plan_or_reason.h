// tests/partition/published/plan_or_reason.h
//
// Where all goes wrong at once: flat boxes, edge-on and aligned lights, lights at the eye, points.
// In:   Random.
// Out:  MethodInput that is valid; there may be no map. A check of what comes of it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "methods/view_body.h"
#include "partition/plan.h"
#include "tests/methods/random_input.h"

namespace lightfit::testing {

inline MethodInput HardInput(Random& random) {
  MethodInput input = RandomInput(random);
  input.map = {random.Int(20, 600), random.Int(20, 600)};
  const Eigen::Vector3d eye = EyePosition(input.camera);
  const Eigen::Vector3d view = ViewDirection(input.camera);
  const int flat_axis = random.Int(0, 5);
  if (flat_axis < 3) input.receivers.min()(flat_axis) = input.receivers.max()(flat_axis);
  if (flat_axis == 4) input.receivers.min() = input.receivers.max();
  switch (random.Int(0, 6)) {
    case 0:
      input.light = Light::Directional("sun", random.Coin() ? view : Eigen::Vector3d(-view));
      break;
    case 1:
      input.light = Light::Point("lamp", eye - random.Int(0, 1) * random.Uniform(0.0, 1.0) * view);
      break;
    case 2:
      input.light = Light::Point(
          "lamp",
          random.Coin() ? input.receivers.max() : Eigen::Vector3d(input.receivers.center()));
      break;
    case 3:
      input.light = Light::Directional("sun", Eigen::Vector3d::Unit(random.Int(0, 2)));
      break;
    case 4:
      input.camera.orthographic = true;
      input.camera.screen_from_camera(0, 0) = 20.0 / input.camera.near;
      input.camera.screen_from_camera(1, 1) = 20.0 / input.camera.near;
      break;
    case 5:
      input.light = Light::Point("lamp", eye + view * input.camera.far);
      break;
    default:
      break;
  }
  return input;
}

// A plan of finite maps that hold what is in view and take no more than the budget; or a reason.
// Returns whether there is one.
inline bool IsPlanOrReason(const absl::StatusOr<Plan>& plan, const MethodInput& input) {
  if (!plan.ok()) {
    EXPECT_EQ(plan.status().code(), absl::StatusCode::kFailedPrecondition) << plan.status();
    return false;
  }
  EXPECT_LE(NumTexels(*plan), int64_t{input.map.width} * input.map.height);
  for (const PlanMap& map : plan->maps) {
    EXPECT_TRUE(map.map_from_world.allFinite());
    for (const Eigen::RowVector4d& half_space : map.half_spaces) {
      EXPECT_TRUE(half_space.allFinite());
    }
  }
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(*plan, input.light);
  EXPECT_TRUE(look_up.ok()) << look_up.status();
  if (!look_up.ok()) return false;
  for (const Eigen::Vector3d& corner : ViewBody(input.camera, input.receivers)) {
    EXPECT_GE(look_up->At(corner).map, 0);
  }
  return true;
}

}  // namespace lightfit::testing
