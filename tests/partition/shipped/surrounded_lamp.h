// tests/partition/shipped/surrounded_lamp.h
//
// A lamp among the boxes that a camera sees: receivers on many sides of it.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/light.h"
#include "methods/view_body.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/random_cases.h"

namespace lightfit::testing {

struct SurroundedLamp {
  Light light;
  SyntheticReadback readback;

  explicit SurroundedLamp(uint64_t seed, int width = 64, int height = 48) {
    const BoxScene scene = MakeBoxScene(seed);
    const Camera camera = lightfit::RandomCamera(scene, seed, width, height);
    Random random(seed);
    Eigen::Vector3d position =
        EyePosition(camera) + random.Uniform(5.0, 15.0) * ViewDirection(camera);
    position.z() = random.Uniform(0.5, 4.0);
    light = Light::Point("lamp", position);
    readback = Render(scene, camera, {&light, 1});
  }

  Surfaces FindSurfaces() const {
    return *lightfit::FindSurfaces(readback.ViewWithFacing(), 1, SampleOptions());
  }
  // In light space.
  Samples Select(const Surfaces& surfaces) const {
    return SelectSamples(
        surfaces, light, SampleOptions(), Eigen::Matrix3d::Identity(), /*with_edge_normals=*/true);
  }
};

}  // namespace lightfit::testing
