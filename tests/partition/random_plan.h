// tests/partition/random_plan.h
//
// Plans that nobody fitted: maps of any size, warp and scale around random axes.
#pragma once

#include <Eigen/Dense>

#include "geometry/homography.h"
#include "geometry/light.h"
#include "partition/plan.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

inline Light RandomPlanLight(Random& random) {
  if (random.Coin()) return Light::Directional("sun", random.UnitVector());
  return Light::Point("lamp", random.InCube(3.0));
}

// A map of the light around a random axis, of a random size and warp.
inline PlanMap RandomPlanMap(const Light& light, Random& random) {
  PlanMap map;
  map.size = {random.Int(40, 400), random.Int(40, 400)};
  Eigen::Matrix3d map_from_ray;
  if (light.kind == Light::Kind::kPoint) {
    map_from_ray = random.Rotation();
  } else {
    map_from_ray = Eigen::Matrix3d::Identity();
    map_from_ray.row(2) << random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), 1.0;
  }
  map_from_ray.topRows<2>() *= random.LogUniform(30.0, 300.0);
  map_from_ray.row(0) += 0.5 * map.size.width * map_from_ray.row(2);
  map_from_ray.row(1) += 0.5 * map.size.height * map_from_ray.row(2);
  map_from_ray *= random.LogUniform(0.01, 100.0);  // a matrix is the same at any scale
  map.map_from_world =
      MapFromWorld(map_from_ray, RayFromWorld(light), light, DepthRange{1.0, 10.0}, 0.1);
  return map;
}

inline Plan RandomPlan(const Light& light, Random& random) {
  Plan plan;
  const int num_maps = random.Int(1, 8);
  for (int k = 0; k < num_maps; ++k) plan.maps.push_back(RandomPlanMap(light, random));
  return plan;
}

}  // namespace lightfit::testing
