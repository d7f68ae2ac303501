#include "geometry/clip.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::MatrixNear;

// The clip point of a texel position and depth, after the division.
Eigen::Vector3d Clip(const ClipConvention& clip, double u, double v, double z, double w = 1.0) {
  constexpr MapSize kMap = {1024, 512};
  const Eigen::Vector4d map(u * w, v * w, z * w, w);
  return (ClipFromMap(kMap, clip) * map).hnormalized();
}

TEST(ClipFromMap, FirstRowIsAtTheBottomOfClipSpaceForVulkanAndOpenGl) {
  EXPECT_THAT(Clip(ClipConvention::Vulkan(), 0.0, 0.0, 0.0),
              MatrixNear(Eigen::Vector3d(-1.0, -1.0, 0.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::Vulkan(), 1024.0, 512.0, 1.0),
              MatrixNear(Eigen::Vector3d(1.0, 1.0, 1.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::OpenGl(), 0.0, 0.0, 0.0),
              MatrixNear(Eigen::Vector3d(-1.0, -1.0, -1.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::OpenGl(), 1024.0, 512.0, 1.0),
              MatrixNear(Eigen::Vector3d(1.0, 1.0, 1.0), 1e-15));
}

TEST(ClipFromMap, FirstRowIsAtTheTopOfClipSpaceForDirect3D) {
  EXPECT_THAT(Clip(ClipConvention::Direct3D(), 0.0, 0.0, 0.0),
              MatrixNear(Eigen::Vector3d(-1.0, 1.0, 0.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::Direct3D(), 256.0, 512.0, 1.0),
              MatrixNear(Eigen::Vector3d(-0.5, -1.0, 1.0), 1e-15));
}

TEST(ClipFromMap, ReversedDepthRunsFromOneToZero) {
  EXPECT_THAT(Clip(ClipConvention::ReversedZ(), 512.0, 256.0, 0.0),
              MatrixNear(Eigen::Vector3d(0.0, 0.0, 1.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::ReversedZ(), 512.0, 256.0, 0.75),
              MatrixNear(Eigen::Vector3d(0.0, 0.0, 0.25), 1e-15));
}

TEST(ClipFromMap, ReversedDepthOfDirect3DHasTheFirstRowAtTheTop) {
  EXPECT_THAT(Clip(ClipConvention::Direct3DReversed(), 0.0, 0.0, 0.0),
              MatrixNear(Eigen::Vector3d(-1.0, 1.0, 1.0), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::Direct3DReversed(), 256.0, 512.0, 0.75),
              MatrixNear(Eigen::Vector3d(-0.5, -1.0, 0.25), 1e-15));
  EXPECT_THAT(Clip(ClipConvention::Direct3DReversed(), 1024.0, 512.0, 1.0),
              MatrixNear(Eigen::Vector3d(1.0, -1.0, 0.0), 1e-15));
}

TEST(ClipFromMap, HoldsForHomogeneousPointsAndKeepsW) {
  const ClipConvention conventions[] = {ClipConvention::Vulkan(),
                                        ClipConvention::Direct3D(),
                                        ClipConvention::OpenGl(),
                                        ClipConvention::ReversedZ(),
                                        ClipConvention::Direct3DReversed()};
  for (const ClipConvention& clip : conventions) {
    EXPECT_THAT(Clip(clip, 100.0, 200.0, 0.3, 17.0),
                MatrixNear(Clip(clip, 100.0, 200.0, 0.3), 1e-14));
    EXPECT_EQ(ClipFromMap({64, 32}, clip).row(3), Eigen::RowVector4d::UnitW());
  }
}

}  // namespace
}  // namespace lightfit
