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

#include "geometry/affine_depth.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/depth_tiles.h"
#include "optimizer/readback/readback.h"
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
  for (const double value : {matrix.figures.energy,
                             matrix.search.energy_start,
                             matrix.figures.footprint.rms,
                             matrix.figures.footprint.median,
                             matrix.figures.footprint.p99,
                             matrix.figures.footprint.worst}) {
    EXPECT_TRUE(std::isfinite(value)) << matrix.BriefReport();
    EXPECT_GE(value, 0.0) << matrix.BriefReport();
  }
  for (const TraceStep& step : matrix.search.trace) EXPECT_TRUE(std::isfinite(step.energy));
}

// The library's search on what Chong & Gortler minimise: squared footprints of their samples, with
// all receivers in the map.
inline FitOptions SquaredFootprints() {
  FitOptions options;
  options.samples = FitOptions::AsPublished().samples;
  options.metric = Metric::kL2;
  options.cover = Cover::kReceivers;
  return options;
}

// What a fitted matrix owes the receivers. Those to cover have 0 <= u <= width, 0 <= v <= height,
// 0 <= z <= 1 and w > 0; those that land in the map without need have z <= 1, or a map that was
// cleared to 1 would shadow them.
inline void ExpectCovers(const LightMatrix& matrix,
                         const Readback& readback,
                         const Light& light,
                         Cover cover = FitOptions().cover) {
  constexpr double kTexelTolerance = 1e-6, kDepthTolerance = 1e-7;
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d map_from_screen = matrix.map_from_world * readback.camera.WorldFromScreen();
  const uint32_t mask = uint32_t{1} << light.shadow_bit;
  const bool any_shadow =
      BuildDepthTiles(readback, affine_depth, {readback.shadow_bits, mask}).num_surfaces > 0;
  double w_min = 1e300, z_min = 1e300, z_max = -1e300, outside = -1e300, z_max_in_map = -1e300;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
      if (!affine_depth.IsSurface(readback.depth[pixel])) continue;
      const Eigen::Vector4d map =
          map_from_screen *
          Eigen::Vector4d(x + 0.5, y + 0.5, affine_depth.At(x, y, readback.depth[pixel]), 1.0);
      const Eigen::Vector3d texel = map.hnormalized();
      const double texels_outside = std::max(
          {-texel.x(), -texel.y(), texel.x() - matrix.map.width, texel.y() - matrix.map.height});
      if (map.w() > 0.0 && texels_outside <= 0.0) z_max_in_map = std::max(z_max_in_map, texel.z());
      const bool is_shadowed = (readback.shadow_bits[pixel] & mask) != 0;
      if (cover == Cover::kShadowed && any_shadow && !is_shadowed) continue;
      w_min = std::min(w_min, map.w());
      z_min = std::min(z_min, texel.z());
      z_max = std::max(z_max, texel.z());
      outside = std::max(outside, texels_outside);
    }
  }
  EXPECT_GT(w_min, 0.0) << matrix.light_name;
  EXPECT_LE(outside, kTexelTolerance) << matrix.light_name;
  EXPECT_GE(z_min, -kDepthTolerance) << matrix.light_name;
  EXPECT_LE(z_max, 1.0 + kDepthTolerance) << matrix.light_name;
  EXPECT_LE(z_max_in_map, 1.0 + kDepthTolerance) << matrix.light_name;
}

}  // namespace lightfit::testing
