// tests/testing/test_scene.h
//
// Ready-made read-backs of random box scenes, and what tests ask of every fitted matrix.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/light.h"
#include "optimizer/footprint_image.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback.h"
#include "tests/testing/box_scene.h"

namespace lightfit::testing {

// A random scene with its lights (suns, near and far points in turn), seen by a random camera.
struct TestScene {
  std::vector<Light> lights;
  SyntheticReadback readback;

  TestScene(uint64_t seed, int num_lights, int width = 96, int height = 64) {
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, num_lights);
    readback = Render(scene, lightfit::RandomCamera(scene, seed, width, height), lights);
  }
  Readback View() const { return readback.View(); }
};

inline void ExpectAllFinite(const LightMatrix& matrix) {
  EXPECT_TRUE(matrix.map_from_world.allFinite()) << matrix.map_from_world;
  for (const double value : {matrix.energy,
                             matrix.energy_start,
                             matrix.footprint.rms,
                             matrix.footprint.median,
                             matrix.footprint.p99,
                             matrix.footprint.worst}) {
    EXPECT_TRUE(std::isfinite(value)) << matrix.BriefReport();
    EXPECT_GE(value, 0.0) << matrix.BriefReport();
  }
  for (const TraceStep& step : matrix.trace) EXPECT_TRUE(std::isfinite(step.energy));
}

// 0 <= u <= width, 0 <= v <= height, 0 <= z <= 1 and w > 0 on every receiver.
inline void ExpectCoversReceivers(const LightMatrix& matrix, const Readback& readback) {
  constexpr double kTexelTolerance = 1e-6, kDepthTolerance = 1e-7;
  const auto positions = ReceiverPositions(readback);
  ASSERT_TRUE(positions.ok()) << positions.status();
  double w_min = 1e300, z_min = 1e300, z_max = -1e300, outside = -1e300;
  for (const Eigen::Vector3d& position : *positions) {
    const Eigen::Vector4d map = matrix.map_from_world * position.homogeneous();
    const Eigen::Vector3d texel = map.hnormalized();
    w_min = std::min(w_min, map.w());
    z_min = std::min(z_min, texel.z());
    z_max = std::max(z_max, texel.z());
    outside = std::max({outside,
                        -texel.x(),
                        -texel.y(),
                        texel.x() - matrix.map.width,
                        texel.y() - matrix.map.height});
  }
  EXPECT_GT(w_min, 0.0) << matrix.light_name;
  EXPECT_LE(outside, kTexelTolerance) << matrix.light_name;
  EXPECT_GE(z_min, -kDepthTolerance) << matrix.light_name;
  EXPECT_LE(z_max, 1.0 + kDepthTolerance) << matrix.light_name;
}

}  // namespace lightfit::testing
