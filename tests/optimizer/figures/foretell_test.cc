#include "optimizer/figures/foretell.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::StatusIs;

const Light kSun = Light::Directional("sun", {0.0, 0.0, 1.0}, 4);
constexpr MapSize kMap = {kMaxMapSide,
                          kMaxMapSide};  // room for everything, unless a test says otherwise

// A wall at depth 4 that faces the camera, seen so that a pixel is 4 / width wide and high. Lit by
// a sun from the camera's side.
PlaneReadback Wall(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.screen_from_camera << width, 0.0, 0.5 * width, 0.0, width, 0.5 * height, 0.0, 0.0, 1.0;
  return PlaneReadback(camera, DepthKind::kCameraZ, Eigen::Vector3d::UnitZ(), 4.0);
}

// The map in which a texel is `J` (pixels per texel) on the wall; the image's middle is in the
// middle of kMap.
Eigen::Matrix4d MapOfJ(const Eigen::Matrix2d& J, int width) {
  const double pixels_per_metre = width / 4.0;
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
  map_from_world.topLeftCorner<2, 2>() = J.inverse() * pixels_per_metre;
  map_from_world(0, 3) = 0.5 * kMap.width;
  map_from_world(1, 3) = 0.5 * kMap.height;
  return map_from_world;
}

double Foretell(const PlaneReadback& readback,
                const Eigen::Matrix4d& map_from_world,
                MapSize map = kMap) {
  const auto share = ForetellWrongShare(readback.View(), kSun, map_from_world, map);
  EXPECT_THAT(share, IsOk());
  return *share;
}

// math.md (12) per unit of edge length: the mean of |n.J delta| over the texel, by a fine grid or
// by the one that the forecast takes.
double MeanReach(const Eigen::Vector2d& normal, const Eigen::Matrix2d& J, int places) {
  double sum = 0.0;
  for (int j = 0; j < places; ++j) {
    for (int i = 0; i < places; ++i) {
      const Eigen::Vector2d delta((i + 0.5) / places - 0.5, (j + 0.5) / places - 0.5);
      sum += std::abs(normal.dot(J * delta));
    }
  }
  return sum / (places * places);
}

// A straight edge through the middle of the image, at many angles and texels of several shapes. The
// forecast per unit of length follows (12) taken on its own 3 x 3 places, which see 8/9 of the
// exact mean or a little more. An edge drawn in whole pixels is jagged: moved along itself it does
// not quite fall on itself, which adds up to a tenth of a pixel; and it ends at the image's border,
// which takes a little away.
TEST(ForetellWrongShare, OfAStraightEdgeIsTheMeanReachTimesItsLength) {
  constexpr int kSide = 160;
  constexpr double kJaggedness = 0.1;  // pixels
  constexpr double kEnds = 0.97;
  Eigen::Matrix2d shapes[5];
  shapes[0] << 3.0, 0.0, 0.0, 3.0;
  shapes[1] << 6.0, 0.0, 0.0, 1.5;
  shapes[2] << 2.0, 1.5, -1.0, 2.5;
  shapes[3] << 0.8, 0.0, 0.0, 0.8;
  shapes[4] << 10.0, 0.0, 0.0, 12.0;
  double most_added = 0.0, least_ratio = 1e300, most_ratio = 0.0;
  for (const Eigen::Matrix2d& J : shapes) {
    for (int degrees = 0; degrees < 180; degrees += 15) {
      const double angle = degrees * M_PI / 180.0;
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      PlaneReadback readback = Wall(kSide, kSide);
      readback.Cast(4, [&](int x, int y) {
        return normal.dot(Eigen::Vector2d(x + 0.5 - 0.5 * kSide, y + 0.5 - 0.5 * kSide)) > 0.0;
      });
      const double length = kSide / std::max(std::abs(normal.x()), std::abs(normal.y()));
      const double reach = Foretell(readback, MapOfJ(J, kSide)) * kSide * kSide / length;
      const double expected = MeanReach(normal, J, 3);
      EXPECT_GE(reach, kEnds * expected) << degrees << " degrees, J\n" << J;
      EXPECT_LE(reach, expected + kJaggedness) << degrees << " degrees, J\n" << J;
      most_added = std::max(most_added, reach - expected);
      const double ratio = reach / MeanReach(normal, J, 200);
      EXPECT_GE(ratio, kEnds * 8.0 / 9.0) << degrees << " degrees, J\n" << J;
      least_ratio = std::min(least_ratio, ratio);
      most_ratio = std::max(most_ratio, ratio);
    }
  }
  std::printf("foretold / (12): %.3f to %.3f; jagged edges add up to %.3f pixels\n",
              least_ratio,
              most_ratio,
              most_added);
}

TEST(ForetellWrongShare, IsZeroWithoutAnEdge) {
  PlaneReadback readback = Wall(60, 40);
  const Eigen::Matrix4d map_from_world = MapOfJ(5.0 * Eigen::Matrix2d::Identity(), 60);
  EXPECT_EQ(Foretell(readback, map_from_world), 0.0);
  readback.Cast(5, [](int x, int) { return x > 30; });  // of another light
  EXPECT_EQ(Foretell(readback, map_from_world), 0.0);
  readback.Cast(4, [](int, int) { return true; });
  EXPECT_EQ(Foretell(readback, map_from_world), 0.0);
}

// Where texels are larger than shadows these are lost (their area is wrong), or come back a texel
// large where one is centred in them (as much again, on the mean).
TEST(ForetellWrongShare, IsBoundedByTwiceTheShadowsAreaHoweverLargeTexelsAre) {
  PlaneReadback readback = Wall(120, 120);
  const auto in_disc = [](int x, int y) { return std::hypot(x - 60.2, y - 59.7) < 5.0; };
  readback.Cast(4, in_disc);
  double area = 0.0;
  for (const uint32_t bits : readback.shadow_bits) area += bits != 0 ? 1.0 : 0.0;
  area /= 120.0 * 120.0;
  double before = 0.0;
  for (const double pixels_per_texel : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const double share =
        Foretell(readback, MapOfJ(pixels_per_texel * Eigen::Matrix2d::Identity(), 120));
    EXPECT_GT(share, before) << pixels_per_texel;
    before = share;
  }
  for (const double pixels_per_texel : {16.0, 40.0, 100.0}) {
    const double share =
        Foretell(readback, MapOfJ(pixels_per_texel * Eigen::Matrix2d::Identity(), 120));
    EXPECT_GT(share, 0.5 * area) << pixels_per_texel;
    EXPECT_LE(share, 2.0 * area) << pixels_per_texel;
  }
  // Larger than the image: no other pixel's texel reaches into the disc.
  EXPECT_LE(Foretell(readback, MapOfJ(1e4 * Eigen::Matrix2d::Identity(), 120)), area);
}

// Pixels in the outermost rows and columns have no derivatives and count as right.
TEST(ForetellWrongShare, EveryDarkPixelOutsideTheMapIsWrong) {
  PlaneReadback readback = Wall(80, 60);
  readback.Cast(4, [](int x, int y) { return x >= 50 && y >= 20; });
  Eigen::Matrix4d map_from_world = MapOfJ(Eigen::Matrix2d::Identity(), 80);
  map_from_world(0, 3) = map_from_world(1, 3) = -1e4;
  EXPECT_NEAR(Foretell(readback, map_from_world), 29.0 * 39.0 / (80.0 * 60.0), 1e-12);
  // A map of tiny texels that ends at column 65: what is dark beyond it, and next to nothing else.
  const double texels = 1e4;
  map_from_world = MapOfJ(1.0 / texels * Eigen::Matrix2d::Identity(), 80);
  map_from_world(0, 3) = 40.0 * texels;
  map_from_world(1, 3) = 30.0 * texels;
  const MapSize to_column_65 = {static_cast<int>(65 * texels), static_cast<int>(60 * texels)};
  EXPECT_NEAR(Foretell(readback, map_from_world, to_column_65), 14.0 * 39.0 / (80.0 * 60.0), 1e-4);
}

// Half the texels along u and v: twice the reach, but for what jagged edges add to small texels.
TEST(ForetellWrongShare, GrowsInProportionToTheTexels) {
  PlaneReadback readback = Wall(160, 120);
  readback.Cast(4, [](int x, int y) { return std::hypot(x - 80.3, y - 60.6) < 40.0; });
  double before = 0.0;
  for (const double pixels_per_texel : {0.5, 1.0, 2.0, 4.0}) {
    const double share =
        Foretell(readback, MapOfJ(pixels_per_texel * Eigen::Matrix2d::Identity(), 160));
    if (before > 0.0) {
      EXPECT_NEAR(share / before, 2.0, 0.15) << pixels_per_texel;
    }
    before = share;
  }
}

// The same picture in 1920 x 1080, looked at on a grid, and in 320 x 180, looked at in full.
TEST(ForetellWrongShare, LargeReadbacksAgreeWithSmallOnes) {
  const auto is_dark = [](double x, double y) {  // of the image's width and height
    return std::hypot((x - 0.5) * 16.0, (y - 0.5) * 9.0) < 3.0 || x + 0.3 * y > 0.9;
  };
  double shares[2];
  for (const int i : {0, 1}) {
    const int width = i == 0 ? 320 : 1920, height = i == 0 ? 180 : 1080;
    PlaneReadback readback = Wall(width, height);
    readback.Cast(4, [&](int x, int y) { return is_dark((x + 0.5) / width, (y + 0.5) / height); });
    // A texel is a hundredth of the image wide.
    shares[i] = Foretell(readback, MapOfJ(0.01 * width * Eigen::Matrix2d::Identity(), width));
  }
  std::printf("foretold %.5f at 320 x 180, %.5f at 1920 x 1080\n", shares[0], shares[1]);
  EXPECT_NEAR(shares[1] / shares[0], 1.0, 0.05);
}

// A wall in front of another: what is dark on one does not spread onto the other.
TEST(ForetellWrongShare, ShadowsStayOnTheirSurface) {
  PlaneReadback readback = Wall(80, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 40; x < 80; ++x) readback.depth[readback.Index(x, y)] *= 2.0f;
  }
  readback.Cast(4, [](int x, int) { return x >= 40; });
  EXPECT_EQ(Foretell(readback, MapOfJ(3.0 * Eigen::Matrix2d::Identity(), 80)), 0.0);
}

TEST(ForetellWrongShare, RejectsBadInput) {
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  const PlaneReadback readback = Wall(40, 30);
  const Eigen::Matrix4d good = MapOfJ(Eigen::Matrix2d::Identity(), 40);
  Eigen::Matrix4d bad = good;
  bad(3, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(ForetellWrongShare(readback.View(), kSun, bad, kMap),
              StatusIs(kInvalid, HasSubstr("map_from_world")));
  EXPECT_THAT(ForetellWrongShare(readback.View(), Light::Directional("sun", {0, 0, 0}), good, kMap),
              StatusIs(kInvalid, HasSubstr("light \"sun\"")));
  Readback view = readback.View();
  view.shadow_bits = view.shadow_bits.subspan(1);
  EXPECT_THAT(ForetellWrongShare(view, kSun, good, kMap),
              StatusIs(kInvalid, HasSubstr("readback.shadow_bits")));
}

// Images without inner pixels, and surfaces that face away, foretell nothing.
TEST(ForetellWrongShare, IsZeroWhereNothingIsKnown) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 2), std::pair(40, 1)}) {
    PlaneReadback readback = Wall(width, height);
    readback.Cast(4, [](int x, int) { return x % 2 == 0; });
    EXPECT_EQ(Foretell(readback, MapOfJ(Eigen::Matrix2d::Identity(), width)), 0.0);
  }
  PlaneReadback readback = Wall(40, 30);
  readback.Cast(4, [](int x, int) { return x > 20; });
  const auto share = ForetellWrongShare(readback.View(),
                                        Light::Directional("behind", {0.0, 0.0, -1.0}, 4),
                                        MapOfJ(Eigen::Matrix2d::Identity(), 40),
                                        kMap);
  ASSERT_THAT(share, IsOk());
  EXPECT_EQ(*share, 0.0);
}

}  // namespace
}  // namespace lightfit
