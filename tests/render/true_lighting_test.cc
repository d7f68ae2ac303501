#include "render/true_lighting.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::Random;

TEST(TrueLighting, AgreesWithAnalyticBoxes) {
  for (const uint64_t seed : {41, 42, 43}) {
    SCOPED_TRACE(seed);
    const BoxScene boxes = MakeBoxScene(seed);
    const RayCaster caster = testing::Caster(testing::SceneOf(boxes));
    const Camera camera = RandomCamera(boxes, seed, 120, 80);
    const std::vector<Light> lights = RandomLights(boxes, seed, 6);
    const SyntheticReadback expected = Render(boxes, camera, lights);
    const auto image = RenderSurfaces(caster, camera);
    ASSERT_THAT(image, testing::IsOk());
    for (const Light& light : lights) {
      const std::vector<Lighting> lighting = TrueLighting(caster, *image, light);
      int num_different = 0;
      for (size_t i = 0; i < lighting.size(); ++i) {
        // The synthetic read-backs do not tell the two kinds of dark apart.
        const bool is_dark =
            lighting[i] == Lighting::kShadowed || lighting[i] == Lighting::kFacingAway;
        const bool expected_dark = (expected.shadow_bits[i] >> light.shadow_bit & 1U) != 0;
        if (is_dark != expected_dark) ++num_different;
      }
      EXPECT_LE(num_different, 10) << light.name;  // of 9600: pixels on an edge
      const LightingCounts counts = CountLighting(lighting);
      EXPECT_EQ(counts.background + counts.facing_away + counts.lit + counts.shadowed,
                static_cast<int64_t>(lighting.size()));
      EXPECT_EQ(counts.background, 120 * 80 - image->num_surface);
      EXPECT_GT(counts.lit, 0) << light.name;
    }
  }
}

TEST(TrueLighting, IsBruteForceOnRandomTriangles) {
  Random random(44);
  const RayCaster caster = testing::Caster(testing::RandomTriangles(random, 120, 10.0));
  const auto image = RenderSurfaces(
      caster, *LookAtCamera({0, -18, 3}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, 48, 48));
  ASSERT_THAT(image, testing::IsOk());
  int num_compared = 0, num_shadowed = 0;
  for (const Light& light : {Light::Point("lamp", {2, -7, 14}),
                             Light::Point("far", {3e4, -7e4, 9e4}),
                             Light::Directional("sun", {0.3, 0.5, -1})}) {
    const std::vector<Lighting> lighting = TrueLighting(caster, *image, light);
    for (size_t i = 0; i < lighting.size(); ++i) {
      const SurfacePoint& pixel = image->pixels[i];
      if (!pixel.is_surface()) continue;
      const bool is_point = light.kind == Light::Kind::kPoint;
      const Eigen::Vector3d to_light = is_point ? Eigen::Vector3d(light.position - pixel.position)
                                                : Eigen::Vector3d(-light.direction);
      const double range = is_point ? to_light.norm() : 1e300;
      const Eigen::Vector3d direction = to_light.normalized();
      if (std::abs(pixel.normal.dot(direction)) < 1e-3) continue;
      ASSERT_EQ(pixel.normal.dot(direction) < 0, lighting[i] == Lighting::kFacingAway);
      if (lighting[i] == Lighting::kFacingAway) continue;
      constexpr double kOff = 1e-3;  // the surface itself
      const testing::BruteHits hits =
          testing::AllHits(caster.scene(), {pixel.position + kOff * direction, direction});
      if (hits.near_an_edge) continue;
      const bool is_blocked = !hits.distances.empty() && hits.distances[0] < range - kOff;
      ++num_compared;
      num_shadowed += is_blocked;
      EXPECT_EQ(lighting[i] == Lighting::kShadowed, is_blocked) << light.name << " pixel " << i;
    }
  }
  EXPECT_GT(num_compared, 500);
  EXPECT_GT(num_shadowed, 100);
}

TEST(TrueLighting, APointLightDoesNotSeeBehindItself) {
  Scene scene;
  testing::AddFloor(10.0, &scene);
  testing::AddQuad({-10, -10, 5}, {10, -10, 5}, {10, 10, 5}, {-10, 10, 5}, &scene);
  const RayCaster caster = testing::Caster(scene);
  const auto image = RenderSurfaces(
      caster, *LookAtCamera({0, -3, 2}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.8, 16, 16));
  ASSERT_THAT(image, testing::IsOk());
  const LightingCounts below =
      CountLighting(TrueLighting(caster, *image, Light::Point("a", {0, 0, 4})));
  EXPECT_EQ(below.lit, 256);
  const LightingCounts above =
      CountLighting(TrueLighting(caster, *image, Light::Point("a", {0, 0, 6})));
  EXPECT_EQ(above.shadowed, 256);
  const LightingCounts under =
      CountLighting(TrueLighting(caster, *image, Light::Point("a", {0, 0, -6})));
  EXPECT_EQ(under.facing_away, 256);
}

TEST(TrueLighting, ALightOnTheSurfaceIsNoFault) {
  Scene scene;
  testing::AddFloor(10.0, &scene);
  const RayCaster caster = testing::Caster(scene);
  const auto image = RenderSurfaces(
      caster, *LookAtCamera({0, -3, 2}, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.8, 8, 8));
  ASSERT_THAT(image, testing::IsOk());
  const Eigen::Vector3d position = image->pixels[20].position;
  for (const double height : {0.0, 1e-9, caster.Resolution(position), 1e-3}) {
    const Light light = Light::Point("a", position + height * Eigen::Vector3d::UnitZ());
    EXPECT_EQ(CountLighting(TrueLighting(caster, *image, light)).shadowed, 0) << height;
  }
}

TEST(TrueLighting, IsTheSameOnAnyNumberOfThreads) {
  const BoxScene boxes = MakeBoxScene(45);
  const Camera camera = RandomCamera(boxes, 45, 150, 100);
  const Light light = RandomLights(boxes, 45, 1)[0];
  std::vector<SurfaceImage> images;
  std::vector<std::vector<Lighting>> lightings;
  for (const int num_threads : {1, 2, 5}) {
    const RayCaster caster = testing::Caster(testing::SceneOf(boxes), num_threads);
    auto image = RenderSurfaces(caster, camera);
    ASSERT_THAT(image, testing::IsOk());
    lightings.push_back(TrueLighting(caster, *image, light));
    images.push_back(*std::move(image));
  }
  for (int i = 1; i < 3; ++i) {
    EXPECT_EQ(lightings[i], lightings[0]);
    for (size_t p = 0; p < images[0].pixels.size(); ++p) {
      EXPECT_EQ(images[i].pixels[p].triangle, images[0].pixels[p].triangle);
      EXPECT_EQ(images[i].pixels[p].position, images[0].pixels[p].position);
      EXPECT_EQ(images[i].pixels[p].camera_z, images[0].pixels[p].camera_z);
    }
  }
}

}  // namespace
}  // namespace lightfit
