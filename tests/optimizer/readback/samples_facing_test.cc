// The samples with the third state, against all pixels one by one: lit pixels beside dark ones.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "geometry/affine_depth.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::FloorReadback;
using testing::PlaneReadback;
using testing::Random;
using testing::TestScene;

enum class State { kBackground, kAway, kLit, kDark };

State StateOf(const Readback& readback, const Light& light, int x, int y) {
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const size_t i = readback.Index(x, y);
  if (!affine_depth.IsSurface(readback.depth[i])) return State::kBackground;
  if ((readback.facing_bits[i] >> light.shadow_bit & 1u) == 0) return State::kAway;
  return (readback.shadow_bits[i] >> light.shadow_bit & 1u) != 0 ? State::kDark : State::kLit;
}

bool IsAtAnEdge(const Readback& readback, const Light& light, int x, int y) {
  const State state = StateOf(readback, light, x, y);
  if (state != State::kLit && state != State::kDark) return false;
  const State other = state == State::kLit ? State::kDark : State::kLit;
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    if (StateOf(readback, light, x + dx, y + dy) == other) return true;
  }
  return false;
}

// Whether the depth has a plane there that is good for both the eye and the light. Perspective.
bool HasGoodPlane(
    const Readback& readback, const Light& light, const SampleOptions& options, int x, int y) {
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  DepthGradient gradient;
  if (!DepthGradientAt(readback, affine_depth, options, x, y, &gradient)) return false;
  const Eigen::Vector3d normal =
      SurfaceNormal(readback.camera.ScreenFromWorld(), false, x, y, gradient);
  const Eigen::Vector3d position =
      (readback.camera.WorldFromScreen() * Eigen::Vector4d(x + 0.5, y + 0.5, gradient.d, 1.0))
          .hnormalized();
  const Eigen::Matrix4d world_from_camera = readback.camera.camera_from_world.inverse();
  const Eigen::Vector3d to_eye = world_from_camera.topRightCorner<3, 1>() - position;
  const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                       ? Eigen::Vector3d(light.position - position)
                                       : Eigen::Vector3d(-light.direction);
  return normal.dot(to_eye.normalized()) >= options.min_cos_eye &&
         normal.dot(to_light.normalized()) > options.min_cos_light;
}

using Pixels = std::vector<std::pair<int, int>>;

// Those of a map with a dark border, wherever they lie.
Pixels SamplesOf(const Readback& readback, const Light& light, const SampleOptions& samples_of) {
  FitOptions options;
  options.samples = samples_of;
  options.cover = Cover::kReceivers;
  options.border = BorderChoice::kDark;
  const Surfaces surfaces = *FindSurfaces(readback, uint32_t{1} << light.shadow_bit, samples_of);
  const Samples samples = ViewLight(surfaces, light, options)->samples;
  const SampleCounts& counts = samples.counts;
  EXPECT_EQ(counts.used, static_cast<int64_t>(samples.size()));
  EXPECT_EQ(
      counts.used + counts.background + counts.discontinuity + counts.facing_away + counts.edge_on,
      counts.candidates);
  Pixels pixels;
  for (size_t i = 0; i < samples.size(); ++i) {
    pixels.emplace_back(static_cast<int>(samples.x[i]), static_cast<int>(samples.y[i]));
  }
  return pixels;
}

// Counts those at an edge that have no good plane.
Pixels ByBruteForce(const Readback& readback,
                    const Light& light,
                    const SampleOptions& options,
                    int* num_without_plane) {
  Pixels pixels;
  for (int y = 1; y + 1 < readback.height(); ++y) {
    for (int x = 1; x + 1 < readback.width(); ++x) {
      if (!IsAtAnEdge(readback, light, x, y)) continue;
      if (HasGoodPlane(readback, light, options, x, y)) {
        pixels.emplace_back(x, y);
      } else {
        ++*num_without_plane;
      }
    }
  }
  return pixels;
}

// As rendered; with some bits turned over and some pixels made background, whose bits say nothing.
TEST(SamplesWithFacing, AreTheLitPixelsBesideDarkOnesAndTheOtherWayAround) {
  size_t num_samples = 0;
  int num_without_plane = 0, num_lights = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    TestScene scene(seed, 6);
    Random random(600 + seed);
    const bool is_noisy = seed % 2 == 0;
    for (size_t i = 0; i < scene.readback.depth.size() && is_noisy; ++i) {
      if (random.Int(0, 19) == 0) scene.readback.shadow_bits[i] ^= random.Bits();
      if (random.Int(0, 19) == 0) scene.readback.facing_bits[i] ^= random.Bits();
      if (random.Int(0, 39) == 0) scene.readback.depth[i] = kSyntheticBackground;
    }
    const Readback readback = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      SampleOptions options;
      options.use_outlines = random.Coin();
      options.min_cos_light = random.LogUniform(1e-3, 0.3);
      options.min_cos_eye = random.LogUniform(1e-3, 0.3);
      const Pixels expected = ByBruteForce(readback, light, options, &num_without_plane);
      EXPECT_EQ(SamplesOf(readback, light, options), expected);
      num_samples += expected.size();
      num_lights += expected.size() > 20 ? 1 : 0;
    }
  }
  std::printf("%zu samples, %d pixels at edges without a plane\n", num_samples, num_without_plane);
  EXPECT_GE(num_lights, 30);
  EXPECT_GE(num_without_plane, 100);
}

// Of a light that the read-back knows nothing about, though it does about others, the normals tell.
TEST(SamplesWithFacing, AreThoseByNormalsForALightOfWhichItIsNotKnown) {
  const TestScene scene(3, 6);
  Readback readback = scene.readback.ViewWithFacing();
  for (const Light& light : scene.lights) {
    readback.facing_lights = ~(uint32_t{1} << light.shadow_bit);
    EXPECT_EQ(SamplesOf(readback, light, {}), SamplesOf(scene.View(), light, {})) << light.name;
  }
}

// With a lit border the normals tell in any case (LightView says why).
TEST(SamplesWithFacing, AreNotForALitBorder) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const TestScene scene(seed, 3);
    const FitOptions options;
    const auto samples_of = [&](const Readback& readback, const Light& light) {
      const Surfaces surfaces = *FindSurfaces(readback, 7u, options.samples);
      const Samples samples = ViewLight(surfaces, light, options)->samples;
      return std::pair(samples.x, samples.y);
    };
    for (const Light& light : scene.lights) {
      EXPECT_EQ(samples_of(scene.readback.ViewWithFacing(), light), samples_of(scene.View(), light))
          << light.name << ", seed " << seed;
    }
  }
}

// A floor with bits by hand; the light is bit 5, and the other bits are noise.
struct Floor {
  PlaneReadback plane = FloorReadback();
  std::vector<uint32_t> facing;
  Light sun = Light::Directional("sun", {0.3, 0.2, -1.0}, 5);

  Floor() : facing(plane.depth.size(), 0xffff'ff20u) {}
  Readback View() const {
    Readback view = plane.View();
    view.facing_bits = facing;
    return view;
  }
  void TurnAway(int x, int y) { facing[plane.Index(x, y)] &= ~0x20u; }
};

TEST(SamplesWithFacing, AShadowThatDoesNotFaceTheLightIsNone) {
  Floor floor;
  floor.plane.Cast(5, [](int x, int y) { return x >= 10 && x < 20 && y >= 10 && y < 20; });
  EXPECT_EQ(SamplesOf(floor.View(), floor.sun, {}).size(), 36u + 40u);  // inside and outside
  // All of the shadow turned away, as of renderers whose bit is 1 there too.
  for (int y = 10; y < 20; ++y) {
    for (int x = 10; x < 20; ++x) floor.TurnAway(x, y);
  }
  EXPECT_TRUE(SamplesOf(floor.View(), floor.sun, {}).empty());
}

// A terminator lies between dark and away, and is no edge however the bits of what is away are.
TEST(SamplesWithFacing, TerminatorsAreNone) {
  for (const bool bit_of_away : {false, true}) {
    Floor floor;
    floor.plane.Cast(5, [&](int x, int) { return x < 15 || (x >= 25 ? bit_of_away : false); });
    // Dark, lit, away from left to right: one edge of two columns.
    for (int y = 0; y < 30; ++y) {
      for (int x = 25; x < 40; ++x) floor.TurnAway(x, y);
    }
    const Pixels samples = SamplesOf(floor.View(), floor.sun, {});
    EXPECT_EQ(samples.size(), 2u * 28u);
    for (const auto& [x, y] : samples) EXPECT_TRUE(x == 14 || x == 15) << x << ", " << y;
    // And without anything lit none.
    floor.plane.Cast(5, [](int x, int) { return x < 25; });
    EXPECT_TRUE(SamplesOf(floor.View(), floor.sun, {}).empty());
  }
}

TEST(SamplesWithFacing, BackgroundIsNoNeighbour) {
  Floor floor;
  floor.plane.Cast(5, [](int x, int y) { return x == 20 && y == 15; });
  EXPECT_EQ(SamplesOf(floor.View(), floor.sun, {}).size(), 5u);
  floor.plane.depth[floor.plane.Index(20, 15)] = 1e10f;
  EXPECT_TRUE(SamplesOf(floor.View(), floor.sun, {}).empty());
}

}  // namespace
}  // namespace lightfit
