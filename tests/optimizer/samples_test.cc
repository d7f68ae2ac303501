#include "optimizer/samples.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "optimizer/receivers.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::FloorReadback;
using testing::IsOk;
using testing::MatrixNear;
using testing::PlaneReadback;

const Eigen::Matrix3d kLightSpace = Eigen::Matrix3d::Identity();

SampleCounts CountSamples(const PlaneReadback& readback, const Light& light) {
  const absl::StatusOr<Receivers> receivers =
      FindReceivers(readback.View(), 1u << light.shadow_bit, {});
  EXPECT_THAT(receivers, IsOk());
  const Samples samples = SelectSamples(*receivers, light, kLightSpace, false);
  EXPECT_EQ(samples.counts.used, static_cast<int64_t>(samples.size()));
  const SampleCounts& c = samples.counts;
  EXPECT_EQ(c.used, c.candidates - c.background - c.discontinuity - c.facing_away - c.edge_on);
  return c;
}

// Shadow to the right of a column: both columns at the edge are candidates, but for their ends.
PlaneReadback FloorWithVerticalEdge() {
  PlaneReadback readback = FloorReadback();
  readback.Cast(0, [](int x, int) { return x >= 20; });
  return readback;
}
constexpr int64_t kNumCandidates = 2 * (30 - 2);

const Light kSun = Light::Directional("sun", {0.3, 0.2, -1.0});

TEST(SelectSamples, UsesEveryBoundaryPixelOfAPlane) {
  const SampleCounts counts = CountSamples(FloorWithVerticalEdge(), kSun);
  EXPECT_EQ(counts.receivers, 40 * 30);
  EXPECT_EQ(counts.candidates, kNumCandidates);
  EXPECT_EQ(counts.used, kNumCandidates);
}

TEST(SelectSamples, CountsBackgroundAndItsNeighbours) {
  PlaneReadback readback = FloorWithVerticalEdge();
  readback.depth[readback.Index(20, 15)] = 1e10f;
  const SampleCounts counts = CountSamples(readback, kSun);
  EXPECT_EQ(counts.receivers, 40 * 30 - 1);
  EXPECT_EQ(counts.candidates, kNumCandidates);
  EXPECT_EQ(counts.background, 1);
  EXPECT_EQ(counts.discontinuity,
            3);  // left, above and below; the one to the right is no candidate
  EXPECT_EQ(counts.used, kNumCandidates - 4);
}

TEST(SelectSamples, CountsInvalidDepthAsBackground) {
  PlaneReadback readback = FloorWithVerticalEdge();
  readback.depth[readback.Index(20, 15)] = std::nanf("");
  const SampleCounts counts = CountSamples(readback, kSun);
  EXPECT_EQ(counts.invalid_depth, 1);
  EXPECT_EQ(counts.background, 1);
  EXPECT_EQ(counts.discontinuity, 3);
}

TEST(SelectSamples, CountsDepthDiscontinuities) {
  PlaneReadback readback = FloorWithVerticalEdge();
  for (int y = 0; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) readback.depth[readback.Index(x, y)] *= 1.5f;
  }
  const SampleCounts counts = CountSamples(readback, kSun);
  EXPECT_EQ(counts.candidates, kNumCandidates);
  EXPECT_EQ(counts.discontinuity, kNumCandidates);
  EXPECT_EQ(counts.used, 0);
}

TEST(SelectSamples, CountsSurfacesFacingAway) {
  const SampleCounts counts =
      CountSamples(FloorWithVerticalEdge(), Light::Directional("below", {0.3, 0.2, 1.0}));
  EXPECT_EQ(counts.facing_away, kNumCandidates);
  const SampleCounts point_counts =
      CountSamples(FloorWithVerticalEdge(), Light::Point("cellar", {0.0, 0.0, -2.0}));
  EXPECT_EQ(point_counts.facing_away, kNumCandidates);
}

TEST(SelectSamples, CountsSurfacesEdgeOnToTheLight) {
  // 0.01 of 0.02 (SampleOptions::min_cos_light) above the horizon.
  const SampleCounts counts =
      CountSamples(FloorWithVerticalEdge(), Light::Directional("dusk", {1.0, 0.0, -0.01}));
  EXPECT_EQ(counts.edge_on, kNumCandidates);
  const SampleCounts above =
      CountSamples(FloorWithVerticalEdge(), Light::Directional("dawn", {1.0, 0.0, -0.03}));
  EXPECT_EQ(above.used, kNumCandidates);
}

TEST(SelectSamples, CountsSurfacesEdgeOnToTheEye) {
  // The eye 5 mm above the floor at a metre: cosine 0.005.
  const Camera camera =
      *LookAtCamera({0.0, -1.0, 0.005}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.002, 40, 30);
  PlaneReadback readback = FloorReadback(camera);
  readback.Cast(0, [](int x, int) { return x >= 20; });
  const SampleCounts counts = CountSamples(readback, kSun);
  EXPECT_EQ(counts.candidates, kNumCandidates);
  EXPECT_EQ(counts.edge_on + counts.discontinuity, kNumCandidates);
  EXPECT_GT(counts.edge_on, 0);
}

TEST(SelectSamples, LightAtAReceiverIsEdgeOnThere) {
  const PlaneReadback readback = FloorWithVerticalEdge();
  const Receivers receivers = *FindReceivers(readback.View(), 1u, {});
  const Light lamp = Light::Point("lamp", receivers.boundary[5].position);
  const SampleCounts counts = CountSamples(readback, lamp);
  EXPECT_EQ(counts.used, 0);
  EXPECT_EQ(counts.edge_on + counts.facing_away, kNumCandidates);
}

TEST(SelectSamples, LooksAtItsOwnBitOnly) {
  PlaneReadback readback = FloorWithVerticalEdge();
  readback.Cast(7, [](int, int y) { return y >= 15; });
  Light lamp = Light::Point("lamp", {0.0, 0.0, 5.0}, 7);
  EXPECT_EQ(CountSamples(readback, lamp).candidates, 2 * (40 - 2));
  EXPECT_EQ(CountSamples(readback, kSun).candidates, kNumCandidates);
  lamp.shadow_bit = 31;
  EXPECT_EQ(CountSamples(readback, lamp).candidates, 0);
}

TEST(SelectSamples, RaysPointFromTheLightToTheReceivers) {
  const PlaneReadback readback = FloorWithVerticalEdge();
  const Receivers receivers = *FindReceivers(readback.View(), 1u, {});
  for (const Light& light : {kSun, Light::Point("lamp", {1.0, 2.0, 4.0})}) {
    const Samples samples = SelectSamples(receivers, light, kLightSpace, false);
    ASSERT_EQ(samples.size(), receivers.boundary.size());
    for (size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3d expected =
          RayFromWorld(light) * receivers.boundary[i].position.homogeneous();
      EXPECT_LT(testing::HomogeneousError(samples.At(i).X, expected), 1e-6);
    }
  }
}

TEST(SelectSamples, KnowsEdgeNormalsOnlyWhenAsked) {
  const PlaneReadback readback = FloorWithVerticalEdge();
  const Receivers with = *FindReceivers(readback.View(), 1u, {});
  EXPECT_FALSE(SelectSamples(with, kSun, kLightSpace, false).has_edge_normals());
  const Samples samples = SelectSamples(with, kSun, kLightSpace, true);
  ASSERT_TRUE(samples.has_edge_normals());
  for (size_t i = 0; i < samples.size(); ++i) {
    EXPECT_THAT(samples.At(i).edge_normal, MatrixNear(Eigen::Vector2d(1.0, 0.0), 0.1));
  }
}

// On straight edges the smoothed bit's gradient is the edge's normal, from lit to shadowed, within
// what a window of 5 x 5 binary pixels can tell.
TEST(ShadowEdgeNormal, FollowsStraightEdgesAtAnyAngle) {
  constexpr double kToleranceRad = 0.25;
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double angle = degrees * M_PI / 180.0;
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    readback.shadow_bits.assign(readback.depth.size(), 0);
    readback.Cast(
        3, [&](int x, int y) { return normal.dot(Eigen::Vector2d(x - 20.2, y - 15.3)) > 0.0; });
    const Eigen::Vector2d found = ShadowEdgeNormal(readback.View(), affine_depth, 3, 2, 20, 15);
    EXPECT_NEAR(found.norm(), 1.0, 1e-12);
    EXPECT_LT(std::acos(std::min(1.0, found.dot(normal))), kToleranceRad) << degrees << " degrees";
  }
}

TEST(ShadowEdgeNormal, IgnoresMissingSurfacesAndTheImagesBorder) {
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  readback.Cast(0, [](int x, int) { return x >= 1; });
  for (int x = 0; x < 40; ++x) readback.depth[readback.Index(x, 16)] = std::nanf("");
  EXPECT_THAT(ShadowEdgeNormal(readback.View(), affine_depth, 0, 2, 1, 15),
              MatrixNear(Eigen::Vector2d(1.0, 0.0), 1e-9));
}

TEST(ShadowEdgeNormal, IsZeroWithoutAnEdge) {
  PlaneReadback readback = FloorReadback();
  const AffineDepth affine_depth(readback.camera, readback.kind);
  EXPECT_EQ(ShadowEdgeNormal(readback.View(), affine_depth, 0, 2, 20, 15), Eigen::Vector2d(0, 0));
  readback.Cast(0, [](int x, int y) { return x == 20 && y == 15; });  // a lone pixel: no direction
  EXPECT_EQ(ShadowEdgeNormal(readback.View(), affine_depth, 0, 2, 20, 15), Eigen::Vector2d(0, 0));
  readback.depth.assign(readback.depth.size(), 1e10f);  // no surface at all
  EXPECT_EQ(ShadowEdgeNormal(readback.View(), affine_depth, 0, 2, 20, 15), Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace lightfit
