#include "optimizer/readback/background.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::PlaneReadback;

constexpr uint32_t kAllLights = ~uint32_t{0};

// A floor whose upper rows are replaced by one depth.
PlaneReadback FloorBelow(float depth, int rows, DepthKind kind = DepthKind::kCameraZ) {
  PlaneReadback readback(FloorCamera(), kind, Eigen::Vector3d::UnitZ(), 0.0);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < readback.camera.width; ++x) readback.depth[readback.Index(x, y)] = depth;
  }
  return readback;
}

bool IsBackground(const PlaneReadback& readback) {
  const std::optional<FarDepth> found = FindFarDepth(readback.View(), kAllLights);
  return found.has_value() && found->is_background;
}

TEST(FindFarDepth, TakesWhatProgramsWriteForBackground) {
  for (const float depth : {65504.0F, 65535.0F, 1e5F, 1e6F, 1e7F, 1e8F}) {
    for (const DepthKind kind : {DepthKind::kCameraZ, DepthKind::kDistance}) {
      const std::optional<FarDepth> found =
          FindFarDepth(FloorBelow(depth, 10, kind).View(), kAllLights);
      ASSERT_TRUE(found.has_value()) << depth;
      EXPECT_TRUE(found->is_background) << depth;
      EXPECT_EQ(found->depth, depth);
      EXPECT_NEAR(found->share, 10.0 / 30.0, 1e-12);
    }
  }
}

TEST(FindFarDepth, FindsFewPixelsOfASkyToo) {
  PlaneReadback readback = FloorBelow(0.0F, 0);
  readback.depth[0] = 65504.0F;
  EXPECT_TRUE(IsBackground(readback));
}

TEST(FindFarDepth, IsSilentOfAFloorAlone) {
  EXPECT_FALSE(FindFarDepth(FloorBelow(0.0F, 0).View(), kAllLights).has_value());
}

// A backdrop: a plane parallel to the screen has one depth, and the floor leads up to it.
TEST(FindFarDepth, AWallThatTheFloorReachesIsASurface) {
  for (const float scale : {1.0F, 100.0F, 15000.0F}) {  // metres, centimetres, 65 km: no matter
    PlaneReadback readback = FloorBelow(0.0F, 0);
    float deepest = 0.0F;
    for (float& depth : readback.depth) {
      depth *= scale;
      deepest = std::max(deepest, depth);
    }
    for (int i = 0; i < 40 * 5; ++i) readback.depth[i] = 1.001F * deepest;
    EXPECT_FALSE(FindFarDepth(readback.View(), kAllLights).has_value()) << scale;
  }
}

// Things close to the camera before a wall far behind, with nothing between.
TEST(FindFarDepth, AWallWithAShadowOnItIsASurface) {
  for (const float depth : {20.0F, 200.0F, 5000.0F}) {
    PlaneReadback readback = FloorBelow(depth, 20);
    readback.Cast(0, [](int x, int y) { return x > 10 && x < 20 && y < 12; });
    EXPECT_FALSE(FindFarDepth(readback.View(), kAllLights).has_value()) << depth;
  }
}

TEST(FindFarDepth, AWallWithoutAShadowIsASurfaceButToldOf) {
  const PlaneReadback readback = FloorBelow(60.0F, 20);
  const std::optional<FarDepth> found = FindFarDepth(readback.View(), kAllLights);
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->is_background);
  EXPECT_NE(found->Text("--background ", "inf").find("taken for a surface"), std::string::npos);
}

TEST(FindFarDepth, OneDistanceOverManyPixelsIsNoWall) {
  EXPECT_TRUE(IsBackground(FloorBelow(40.0F, 10, DepthKind::kDistance)));
}

// From above a floor has one depth, and what stands on it is hardly nearer.
TEST(FindFarDepth, TheFloorOfAnOrthographicCameraIsASurface) {
  PlaneReadback readback = FloorBelow(0.0F, 0);
  readback.camera.orthographic = true;
  for (const float floor : {100.0F, 1e5F, 65504.0F}) {
    for (size_t i = 0; i < readback.depth.size(); ++i) {
      readback.depth[i] = i % 7 == 0 ? floor - 3.0F : floor;
    }
    readback.Cast(0, [](int x, int) { return x > 10; });
    EXPECT_FALSE(IsBackground(readback) && floor != 65504.0F) << floor;
  }
}

TEST(FindFarDepth, DepthsBetweenClipPlanesHaveAFarPlane) {
  EXPECT_FALSE(FindFarDepth(FloorBelow(0.9999F, 10, DepthKind::kNdcZeroToOne).View(), kAllLights)
                   .has_value());
}

TEST(SettleBackground, KeepsWhatTheCallerStates) {
  const PlaneReadback floor = FloorBelow(65504.0F, 10);
  Readback readback = floor.View();
  readback.background = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(SettleBackground(kAllLights, &readback).has_value());
  EXPECT_EQ(*readback.background, std::numeric_limits<float>::infinity());
  readback.background.reset();
  EXPECT_TRUE(SettleBackground(kAllLights, &readback).has_value());
  EXPECT_EQ(*readback.background, 65504.0F);
}

TEST(ValidateReadback, RefusesBackgroundsThatAreNoDepth) {
  const PlaneReadback floor = FloorBelow(65504.0F, 10);
  for (const float bad : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    Readback readback = floor.View();
    readback.background = bad;
    EXPECT_NE(ValidateReadback(readback).message().find("readback.background"), std::string::npos);
  }
  Readback readback = floor.View();
  readback.depth_kind = DepthKind::kNdcZeroToOne;
  readback.background = 0.5F;
  EXPECT_NE(ValidateReadback(readback).message().find("far plane"), std::string::npos);
}

}  // namespace
}  // namespace lightfit
