#include "partition/shipped/sample_distribution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stop_token>

#include "base/stop.h"
#include "methods/view_body.h"
#include "partition/shipped/cascade_parts.h"
#include "partition/shipped/receiver_pixels.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// Camera depths of a read-back's surfaces, pixel by pixel; depth is camera z.
std::vector<double> DepthsOf(const Readback& readback) {
  std::vector<double> depths;
  for (const float depth : readback.depth) {
    if (depth < 1e9f) depths.push_back(depth);
  }
  return depths;
}

Eigen::Vector4d MapPoint(const PlanMap& map, const Eigen::Vector3d& world) {
  const Eigen::Vector4d at = map.map_from_world * world.homogeneous();
  return {at.x() / at.w(), at.y() / at.w(), at.z() / at.w(), at.w()};
}

TEST(SampleDistribution, SplitsTheDepthsThatAreSeenLogarithmically) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const testing::TestScene scene(seed, 1);
    const auto surfaces = FindSurfaces(scene.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    const std::vector<double> depths = DepthsOf(scene.View());
    const auto [nearest, furthest] = std::minmax_element(depths.begin(), depths.end());
    const auto plan = SampleDistributionMaps(*surfaces, scene.lights[0], 100'000, {4});
    ASSERT_THAT(plan, IsOk());
    ASSERT_EQ(plan->maps.size(), 4u);
    for (int k = 0; k < 4; ++k) {
      const auto& half_spaces = plan->maps[k].half_spaces;
      ASSERT_EQ(half_spaces.size(), k == 0 || k == 3 ? 1u : 2u);
      // The depth at which the last half space, that of the far end, is zero; of the last map the
      // near end.
      const double end = half_spaces.back()(3) * (k == 3 ? -1.0 : 1.0) +
                         scene.View().camera.camera_from_world(2, 3);
      const double share = k == 3 ? 0.75 : (k + 1) / 4.0;
      EXPECT_NEAR(end / (*nearest * std::pow(*furthest / *nearest, share)), 1.0, 1e-6);
    }
  }
}

TEST(SampleDistribution, HoldsEveryReceiverInTheMapOfItsDepthTightly) {
  constexpr double kTexelTolerance = 1e-6;
  for (const bool min_area : {false, true}) {
    for (uint64_t seed = 1; seed <= 6; ++seed) {
      const testing::TestScene scene(seed, 3);
      const auto surfaces = FindSurfaces(scene.View(), 7, {});
      ASSERT_THAT(surfaces, IsOk());
      for (const Light& light : scene.lights) {
        SampleDistributionOptions options;
        options.num_maps = 1 + static_cast<int>(seed % 5);
        options.min_area_rotation = min_area;
        const auto plan = SampleDistributionMaps(*surfaces, light, 60'000, options);
        ASSERT_THAT(plan, IsOk());
        EXPECT_LE(NumTexels(*plan), 60'000);
        EXPECT_GT(NumTexels(*plan), 57'000);
        const auto look_up = PlanLookUp::Create(*plan, light);
        ASSERT_THAT(look_up, IsOk());
        std::vector<Eigen::AlignedBox2d> filled(plan->maps.size());
        ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
          const PlanPlace middle = look_up->At(pixel.points[0]);
          ASSERT_GE(middle.map, 0);
          for (const Eigen::Vector3d& point : pixel.points) {
            Eigen::Vector2d texel;
            for (size_t k = 0; k < plan->maps.size(); ++k) {
              const PlanMap& map = plan->maps[k];
              bool may_ask = true;
              for (const auto& half_space : map.half_spaces) {
                may_ask &= half_space * point.homogeneous() >= 0.0;
              }
              if (!may_ask) continue;
              const Eigen::Vector4d at = MapPoint(map, point);
              EXPECT_GT(at.w(), 0.0);
              EXPECT_GE(at.head<2>().minCoeff(), -kTexelTolerance);
              EXPECT_LE(at.head<2>().maxCoeff(), map.size.width + kTexelTolerance);
              EXPECT_GE(at.z(), -1e-7);
              EXPECT_LE(at.z(), 1.0 + 1e-7);
              filled[k].extend(at.head<2>());
            }
          }
        });
        // A pixel that lies in two parts is in the boxes of both with all of its corners, so the
        // box of the corners in a part alone is a little smaller than the map.
        for (size_t k = 0; k < plan->maps.size(); ++k) {
          const double side = plan->maps[k].size.width;
          EXPECT_LE(filled[k].min().maxCoeff(), 0.2 * side);
          EXPECT_GE(filled[k].max().minCoeff(), 0.8 * side);
          if (plan->maps.size() > 1) continue;
          EXPECT_NEAR(filled[k].min().norm(), 0.0, kTexelTolerance);
          EXPECT_NEAR(filled[k].max().minCoeff(), side, kTexelTolerance);
        }
      }
    }
  }
}

// A wall at 2 m before a wall at 50 m: nothing between.
struct TwoWalls {
  Camera camera = *LookAtCamera({0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 0.7, 24, 20);
  std::vector<float> depth;
  std::vector<uint32_t> shadow_bits = std::vector<uint32_t>(24 * 20, 0);

  TwoWalls() {
    for (int i = 0; i < 24 * 20; ++i) depth.push_back(i % 24 < 12 ? 2.0f : 50.0f);
  }
  Readback View() const { return {camera, depth, DepthKind::kCameraZ, shadow_bits}; }
};

TEST(SampleDistribution, GivesThePartsWithoutReceiversToTheOthers) {
  const TwoWalls walls;
  const auto surfaces = FindSurfaces(walls.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  const Light light = Light::Directional("sun", {0.3, 1.0, -0.5});
  const auto plan = SampleDistributionMaps(*surfaces, light, 20'000, {5});
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 2u);
  EXPECT_EQ(plan->maps[0].size.width, 100);
  const auto look_up = PlanLookUp::Create(*plan, light);
  ASSERT_THAT(look_up, IsOk());
  EXPECT_EQ(look_up->At({-0.1, 2.0, 0.0}).map, 0);
  EXPECT_EQ(look_up->At({1.0, 50.0, 0.0}).map, 1);
  // Depths between belong to the part before; here it is in its box.
  const auto is_askable = [&](int k, double depth) {
    Eigen::Vector2d texel;
    // The sun's ray through a point of the near wall.
    const Eigen::Vector3d world = Eigen::Vector3d(-0.3, 2.0, 0.0) + (depth - 2.0) * light.direction;
    return look_up->IsAskable(k, world, &texel);
  };
  EXPECT_TRUE(is_askable(0, 10.0));
  EXPECT_FALSE(is_askable(1, 10.0));
}

TEST(SampleDistribution, LeavesOutWhatTheLightSeesEdgeOn) {
  const TwoWalls walls;
  const auto surfaces = FindSurfaces(walls.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  // Both walls face the camera along y.
  EXPECT_THAT(
      SampleDistributionMaps(*surfaces, Light::Directional("sun", {1.0, 0.0, -0.5}), 20'000, {2}),
      StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("in one plane with the light")));
  // A lamp in the plane of the near wall sees only the far one.
  const Light lamp = Light::Point("lamp", {0.0, 2.0, 30.0});
  const auto plan = SampleDistributionMaps(*surfaces, lamp, 20'000, {2});
  ASSERT_THAT(plan, IsOk());
  EXPECT_EQ(plan->maps.size(), 1u);
}

TEST(SampleDistribution, OfAnOrthographicViewIsSplitUniformly) {
  Camera camera = testing::FloorCamera(20, 16);
  camera.orthographic = true;
  camera.screen_from_camera(0, 0) = camera.screen_from_camera(1, 1) = 4.0;
  camera.camera_from_world(2, 3) = 0.0;  // half of the floor is behind the eye
  const testing::PlaneReadback floor = testing::FloorReadback(camera);
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  const Light light = Light::Directional("sun", {0.3, 0.2, -1.0});
  const auto plan = SampleDistributionMaps(*surfaces, light, 20'000, {2});
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 2u);
  const std::vector<double> depths = DepthsOf(floor.View());
  const auto [nearest, furthest] = std::minmax_element(depths.begin(), depths.end());
  EXPECT_NEAR(plan->maps[0].half_spaces[0](3), 0.5 * (*nearest + *furthest), 1e-6);
}

TEST(SampleDistribution, SaysWhatIsWrong) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  const Light sun = Light::Directional("sun", {0.3, 0.2, -1.0});
  EXPECT_THAT(SampleDistributionMaps(*surfaces, sun, 1000, {0}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("num_maps = 0")));
  EXPECT_THAT(SampleDistributionMaps(*surfaces, sun, 0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_texels = 0")));
  EXPECT_THAT(SampleDistributionMaps(*surfaces, Light::Point("lamp", {0.0, 0.0, 1e-4}), 1000, {1}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("among the receivers")));
  std::stop_source source;
  source.request_stop();
  const StopScope scope(source.get_token());
  EXPECT_THAT(SampleDistributionMaps(*surfaces, sun, 1000),
              StatusIs(absl::StatusCode::kCancelled, HasSubstr("sun")));
}

}  // namespace
}  // namespace lightfit
