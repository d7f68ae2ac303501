// tests/partition/tracking/plan_walk.h
//
// A camera that walks through a random box scene, for tests of plans over frames.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/box_scene.h"

namespace lightfit::testing {

// Does not move, as its parts refer to each other.
struct PlanWalk {
  std::vector<Light> lights;  // a sun, a near lamp, a far one
  std::vector<SyntheticReadback> images;
  std::vector<Surfaces> frames;

  // `step`: ahead, metres a frame; half of it to the side, and a turn of as many radians / 10.
  PlanWalk(uint64_t seed, int num_frames, double step, int width = 96, int height = 72) {
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, 3);
    const Camera start = RandomCamera(scene, seed, width, height);
    for (int i = 0; i < num_frames; ++i) {
      Camera camera = start;
      Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
      moved.rotate(Eigen::AngleAxisd(0.1 * step * i, Eigen::Vector3d::UnitY()));
      moved.translate(-step * i * Eigen::Vector3d(0.5, 0.0, 1.0));
      camera.camera_from_world = moved.matrix() * start.camera_from_world;
      images.push_back(Render(scene, camera, lights));
    }
    for (const SyntheticReadback& image : images) {
      frames.push_back(*FindSurfaces(image.ViewWithFacing(), 0x7, {}));
    }
  }
  PlanWalk(const PlanWalk&) = delete;
};

}  // namespace lightfit::testing
