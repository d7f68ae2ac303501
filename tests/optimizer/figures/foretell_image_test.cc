// Which pixels will be wrong, beside how many of them.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "optimizer/figures/foretell.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::PlaneReadback;

const Light kSun = Light::Directional("sun", {0.0, 0.0, 1.0}, 0);
constexpr MapSize kMap = {kMaxMapSide, kMaxMapSide};  // room for everything
constexpr double kRounding = 1e-6;                    // of floats in an image

// A wall at depth 4 that faces the camera, and a map of it in which a texel is `pixels` wide.
PlaneReadback Wall(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.screen_from_camera << width, 0.0, 0.5 * width, 0.0, width, 0.5 * height, 0.0, 0.0, 1.0;
  return PlaneReadback(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 4.0);
}

SizedMatrix MapOf(double pixels, int width) {
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
  map_from_world(0, 0) = map_from_world(1, 1) = width / 4.0 / pixels;
  map_from_world(0, 3) = map_from_world(1, 3) = 0.5 * kMaxMapSide;
  return {map_from_world, kMap};
}

std::vector<float> ImageOf(const Readback& readback,
                           const SizedMatrix& map,
                           Border border = Border::kLit,
                           const Light& light = kSun) {
  const auto image =
      ForetellWrongImage(readback, light, absl::MakeConstSpan(&map, 1), SampleOptions(), border);
  EXPECT_THAT(image, IsOk());
  return image.ok() ? *image : std::vector<float>();
}

// A straight edge between two columns, and texels of four pixels: a pixel is wrong as often as the
// centre of its texel, at one of three places along x, falls across the edge, which is as soft as
// the pixels are wide.
TEST(ForetellWrongImage, IsTheShareOfPlacesAcrossTheEdge) {
  PlaneReadback readback = Wall(60, 40);
  readback.Cast(0, [](int x, int) { return x >= 30; });
  const std::vector<float> image = ImageOf(readback.View(), MapOf(4.0, 60));
  for (int x = 1; x < 59; ++x) {
    const double bit = x >= 30 ? 1.0 : 0.0;
    double expected = 0.0;
    for (const double place : {x + 0.5 - 4.0 / 3.0, x + 0.5, x + 0.5 + 4.0 / 3.0}) {
      expected += std::abs(std::clamp(place - 29.5, 0.0, 1.0) - bit) / 3.0;
    }
    EXPECT_NEAR(image[readback.Index(x, 20)], expected, kRounding) << x;
  }
}

TEST(ForetellWrongImage, IsInTheMeanTheShare) {
  for (const bool knows_facing : {false, true}) {
    PlaneReadback wall = Wall(80, 60);
    wall.Cast(0, [](int x, int y) { return std::hypot(x - 40.3, y - 30.6) < 14.0; });
    const std::vector<uint32_t> facing(wall.depth.size(), 1U);
    Readback readback = wall.View();
    if (knows_facing) readback.facing_bits = facing;
    for (const double pixels : {0.5, 2.0, 8.0}) {
      const SizedMatrix map = MapOf(pixels, 80);
      const std::vector<float> image = ImageOf(readback, map);
      double sum = 0.0;
      for (const float wrong : image) sum += wrong;
      const auto share = ForetellWrongShare(readback, kSun, map.map_from_world, map.size);
      ASSERT_THAT(share, IsOk());
      EXPECT_GT(*share, 0.0);
      // With classes the outermost pixels are not looked at.
      const double num_pixels = knows_facing ? 78.0 * 58.0 : 80.0 * 60.0;
      EXPECT_NEAR(sum / num_pixels, *share, kRounding) << knows_facing << ", " << pixels;
    }
  }
}

// Large read-backs too: the share looks at some of their pixels, the image at all.
TEST(ForetellWrongImage, HasEveryPixelOfALargeReadback) {
  PlaneReadback readback = Wall(640, 360);
  readback.Cast(0, [](int x, int) { return x >= 320; });
  const std::vector<float> image = ImageOf(readback.View(), MapOf(4.0, 640));
  for (int y = 1; y < 359; ++y) {
    EXPECT_GT(image[readback.Index(319, y)], 0.0F) << y;
    EXPECT_GT(image[readback.Index(320, y)], 0.0F) << y;
    EXPECT_EQ(image[readback.Index(310, y)], 0.0F) << y;
  }
}

// What the border answers wrongly, whole; nothing of the sky, and nothing but numbers.
TEST(ForetellWrongImage, IsTheBordersFaultOutsideOfTheMap) {
  for (const bool knows_facing : {false, true}) {
    for (const Border border : {Border::kLit, Border::kDark}) {
      PlaneReadback wall = Wall(40, 30);
      wall.Cast(0, [](int x, int) { return x >= 20; });
      for (int x = 0; x < 40; ++x) wall.depth[wall.Index(x, 5)] = 1e10F;
      const std::vector<uint32_t> facing(wall.depth.size(), 1U);
      Readback readback = wall.View();
      if (knows_facing) readback.facing_bits = facing;
      SizedMatrix map = MapOf(1.0, 40);
      map.map_from_world(0, 3) = -1e5;
      const std::vector<float> image = ImageOf(readback, map, border);
      for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) {
          const float wrong = image[wall.Index(x, y)];
          ASSERT_TRUE(std::isfinite(wrong));
          const bool is_inner = x > 0 && x < 39 && y > 0 && y < 29;
          // Beside the sky the depth has no slope, and without classes such pixels count as right.
          const bool is_known = is_inner && y != 5 && (knows_facing || y < 4 || y > 6);
          if (y == 5) {
            EXPECT_EQ(wrong, 0.0F);
          }
          if (!is_known) continue;
          EXPECT_EQ(wrong, (x >= 20) == (border == Border::kLit) ? 1.0F : 0.0F) << x << ", " << y;
        }
      }
    }
  }
}

TEST(ForetellWrongImage, RefusesWhatTheShareRefuses) {
  const PlaneReadback readback = Wall(40, 30);
  EXPECT_FALSE(ForetellWrongImage(readback.View(), kSun, {}).ok());
}

}  // namespace
}  // namespace lightfit
