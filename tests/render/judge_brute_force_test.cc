// The judge against its definition, by all hits of every texel's ray.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "render/judge.h"
#include "render/shadow_map.h"
#include "tests/render/judge_stage.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::Above;
using testing::IsOk;
using testing::kLamp;
using testing::kSun;
using testing::Random;
using testing::Stage;

void ExpectIsBruteForce(const Stage& stage, MapSize size) {
  const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
  const ShadowImage judged = stage.Judged(matrix, size);
  const auto map_from_ray = MapFromRay(matrix, stage.light);
  ASSERT_THAT(map_from_ray, IsOk());
  const MapRays rays(stage.light, *map_from_ray, stage.caster.bounds());
  int num_compared = 0, num_dark = 0, num_skipped = 0;
  for (size_t i = 0; i < stage.truth.size(); ++i) {
    if (stage.truth[i] != Lighting::kLit && stage.truth[i] != Lighting::kShadowed) continue;
    const SurfacePoint& pixel = stage.image.pixels[i];
    const Eigen::Vector4d place = matrix * pixel.position.homogeneous();
    const double u = std::floor(place.x() / place.w()) + 0.5;
    const double v = std::floor(place.y() / place.w()) + 0.5;
    const std::optional<Ray> ray = rays.At(u, v);
    ASSERT_TRUE(ray.has_value());
    const testing::BruteHits hits = testing::AllHits(stage.caster.scene(), *ray);
    const double slope = pixel.normal.dot(ray->direction);
    // Edges and edge-on planes are left to rounding.
    if (hits.near_an_edge || slope > -1e-2) {
      ++num_skipped;
      continue;
    }
    const double wanted = pixel.normal.dot(pixel.position - ray->origin) / slope;
    bool ideal = false, practical = false;
    if (!hits.distances.empty()) {
      double nearest = hits.distances[0];
      for (const double hit : hits.distances) {
        if (std::abs(hit - wanted) < std::abs(nearest - wanted)) nearest = hit;
      }
      ideal = nearest > hits.distances[0] + 1e-4;
      practical = hits.distances[0] < wanted - 1e-4 - 2e-4 * 20.0;  // the default's largest share
      if (std::abs(wanted - hits.distances[0]) < 0.02)
        practical = judged.practical[i] == Lighting::kShadowed;
    }
    ++num_compared;
    num_dark += ideal;
    EXPECT_EQ(judged.ideal[i] == Lighting::kShadowed, ideal) << "pixel " << i;
    EXPECT_EQ(judged.practical[i] == Lighting::kShadowed, practical) << "pixel " << i;
  }
  EXPECT_GT(num_compared, 800);
  EXPECT_GT(num_dark, 50);
  EXPECT_LT(num_skipped, num_compared / 4);
}

TEST(JudgeMatrix, IsBruteForceOnBoxes) {
  Random random(65);
  Scene scene;
  testing::AddFloor(4.0, &scene);
  for (int i = 0; i < 6; ++i) {
    Eigen::Vector3d center = random.InCube(3.0);
    center.z() = random.Uniform(0.5, 2.0);
    testing::AddBox({center, Eigen::Vector3d(0.5, 0.3, 0.4), random.Uniform(0.0, 3.0)}, &scene);
  }
  for (const Light& light : {kSun, kLamp})
    ExpectIsBruteForce(Stage(scene, Above(), light), {24, 24});
}

TEST(JudgeMatrix, IsBruteForceOnRandomTriangles) {
  Random random(66);
  Scene scene = testing::RandomTriangles(random, 60, 5.0);
  testing::AddFloor(4.0, &scene);
  for (const Light& light : {kSun, kLamp})
    ExpectIsBruteForce(Stage(scene, Above(), light), {24, 24});
}

}  // namespace
}  // namespace lightfit
