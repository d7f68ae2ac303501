// tests/render/plan_stage.h
//
// A scene, what a camera sees of it under a light, and random plans for that.
#pragma once

#include <Eigen/Dense>
#include <utility>
#include <vector>

#include "partition/plan.h"
#include "render/judge.h"
#include "tests/render/testing.h"

namespace lightfit::testing {

// The boxes of a seed.
struct PlanStage {
  PlanStage(uint64_t seed, const Light& light, int width = 96, int height = 72, int num_threads = 2)
      : PlanStage(MakeBoxScene(seed), seed, light, width, height, num_threads) {}
  PlanStage(const BoxScene& boxes,
            uint64_t seed,
            const Light& light,
            int width,
            int height,
            int num_threads)
      : caster(Caster(SceneOf(boxes), num_threads)),
        image(*RenderSurfaces(caster, RandomCamera(boxes, seed, width, height))),
        light(light),
        truth(TrueLighting(caster, image, light)) {}

  RayCaster caster;
  SurfaceImage image;
  Light light;
  std::vector<Lighting> truth;
};

// From above: MapAround() looks down.
inline Light RandomLightAbove(Random& random) {
  if (random.Coin()) {
    const Eigen::Vector3d direction(
        random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-1.0, -0.4));
    return Light::Directional("sun", direction);
  }
  return Light::Point(
      "lamp",
      {random.Uniform(-12.0, 12.0), random.Uniform(-12.0, 12.0), random.Uniform(9.0, 20.0)});
}

inline PlanMap PlanMapOf(const Eigen::Matrix4d& map_from_world, MapSize size) {
  PlanMap map;
  map.map_from_world = map_from_world;
  map.size = size;
  return map;
}

// Another map of the same light: `new_from_old` of the old one's (u w, v w, w).
inline Eigen::Matrix4d Changed(const Eigen::Matrix3d& new_from_old,
                               const Eigen::Matrix4d& map_from_world) {
  Eigen::Matrix<double, 3, 4> rows;
  rows << map_from_world.topRows<2>(), map_from_world.row(3);
  rows = (new_from_old * rows).eval();
  Eigen::Matrix4d changed = map_from_world;
  changed.topRows<2>() = rows.topRows<2>();
  changed.row(3) = rows.row(2);
  return changed;
}

inline Eigen::Matrix4d Moved(const Eigen::Matrix4d& map_from_world, const Eigen::Vector2d& texels) {
  Eigen::Matrix3d translation = Eigen::Matrix3d::Identity();
  translation.topRightCorner<2, 1>() = texels;
  return Changed(translation, map_from_world);
}

inline Plan Moved(Plan plan, const Eigen::Vector2d& texels) {
  for (PlanMap& map : plan.maps) map.map_from_world = Moved(map.map_from_world, texels);
  return plan;
}

// A map of a part of what the camera sees. All of it is the square of side 2 around the origin; of
// that the part is one of side 2 * half_side, turned and warped.
inline PlanMap PartMap(const PlanStage& stage,
                       const Eigen::Vector2d& middle,
                       double half_side,
                       double turn_rad,
                       const Eigen::Vector2d& warp,
                       MapSize size) {
  Eigen::Matrix3d part_from_all = Eigen::Matrix3d::Identity();
  part_from_all.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(turn_rad).toRotationMatrix() / half_side;
  // MapAround() has texel (0, 0) in a corner.
  part_from_all.topRightCorner<2, 1>() =
      -(part_from_all.topLeftCorner<2, 2>() * (Eigen::Vector2d(1.0, 1.0) + middle));
  Eigen::Matrix3d warped_from_part = Eigen::Matrix3d::Identity();
  warped_from_part.row(2) << warp.x(), warp.y(), 1.0;
  Eigen::Matrix3d map_from_warped;
  map_from_warped << 0.5 * size.width, 0.0, 0.5 * size.width,  //
      0.0, 0.5 * size.height, 0.5 * size.height,               //
      0.0, 0.0, 1.0;
  return PlanMapOf(Changed(map_from_warped * warped_from_part * part_from_all,
                           MapAround(stage.image, stage.light, {2, 2})),
                   size);
}

inline Eigen::Vector2d InSquare(Random& random, double half_side) {
  const double x = random.Uniform(-half_side, half_side);
  return {x, random.Uniform(-half_side, half_side)};
}

// Some part, of some size, warp and homogeneous scale.
inline PlanMap RandomPart(const PlanStage& stage, Random& random) {
  const MapSize size = {static_cast<int>(random.LogUniform(20, 120)),
                        static_cast<int>(random.LogUniform(20, 120))};
  const Eigen::Vector2d middle = InSquare(random, 0.6), warp = InSquare(random, 0.2);
  const double half_side = random.LogUniform(0.4, 1.2);
  PlanMap map = PartMap(stage, middle, half_side, random.Uniform(-M_PI, M_PI), warp, size);
  map.map_from_world *= random.LogUniform(0.01, 100.0);
  return map;
}

// Maps that each hold nearly all, warped to be densest in directions of their own; as dense as one
// another in the middle, where all of their borders meet.
inline Plan WarpedPlan(const PlanStage& stage, Random& random, int num_maps) {
  Plan plan;
  for (int k = 0; k < num_maps; ++k) {
    const int width = static_cast<int>(random.LogUniform(40, 160));
    const Eigen::Vector2d warp = InSquare(random, 0.3);
    plan.maps.push_back(PartMap(stage,
                                Eigen::Vector2d::Zero(),
                                1.8,
                                random.Uniform(-M_PI, M_PI),
                                warp,
                                {width, 6400 / width}));
  }
  return plan;
}

// Some parts; some of them with a half space that cuts through the scene.
inline Plan RandomPlan(const PlanStage& stage, Random& random, int num_maps) {
  Plan plan;
  plan.border = random.Coin() ? Border::kLit : Border::kDark;
  for (int k = 0; k < num_maps; ++k) {
    PlanMap map = RandomPart(stage, random);
    if (random.Int(0, 2) == 0) {
      Eigen::RowVector4d half_space;
      half_space << random.UnitVector().transpose(), random.Uniform(-1.0, 1.0);
      map.half_spaces.push_back(half_space);
    }
    plan.maps.push_back(map);
  }
  return plan;
}

// A split of the world by one plane through its middle: n and -n.
inline std::pair<Eigen::RowVector4d, Eigen::RowVector4d> RandomSplit(Random& random) {
  Eigen::RowVector4d side;
  side << random.UnitVector().transpose(), random.Uniform(-0.5, 0.5);
  return {side, -side};
}

}  // namespace lightfit::testing
