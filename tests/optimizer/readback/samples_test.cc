#include "optimizer/readback/samples.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "optimizer/fit_options.h"
#include "optimizer/readback/surfaces.h"
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

SampleCounts CountSamples(const PlaneReadback& readback,
                          const Light& light,
                          const SampleOptions& options = FitOptions::AsPublished().samples) {
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(readback.View(), 1u << light.shadow_bit, options);
  EXPECT_THAT(surfaces, IsOk());
  const Samples samples = SelectSamples(*surfaces, light, surfaces->options, kLightSpace, false);
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
  // The pixel itself, and the one to its left, which has shadow on no other side.
  EXPECT_EQ(counts.background, 2);
  EXPECT_EQ(counts.discontinuity, 2);  // above and below; the one to the right is no candidate
  EXPECT_EQ(counts.used, kNumCandidates - 4);
}

// By default the derivative comes from the side that continues.
TEST(SelectSamples, UsesOutlinesUnlessToldNotTo) {
  PlaneReadback readback = FloorWithVerticalEdge();
  readback.depth[readback.Index(20, 15)] = 1e10f;
  const SampleCounts beside_hole = CountSamples(readback, kSun, SampleOptions());
  EXPECT_EQ(beside_hole.background, 2);
  EXPECT_EQ(beside_hole.discontinuity, 0);
  EXPECT_EQ(beside_hole.used, kNumCandidates - 2);
  for (int y = 0; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) readback.depth[readback.Index(x, y)] *= 1.5f;
  }
  const SampleCounts at_step = CountSamples(readback, kSun, SampleOptions());
  EXPECT_EQ(at_step.discontinuity, 0);
}

TEST(SelectSamples, CountsInvalidDepthAsBackground) {
  PlaneReadback readback = FloorWithVerticalEdge();
  readback.depth[readback.Index(20, 15)] = std::nanf("");
  const SampleCounts counts = CountSamples(readback, kSun);
  EXPECT_EQ(counts.invalid_depth, 1);
  EXPECT_EQ(counts.background, 2);
  EXPECT_EQ(counts.discontinuity, 2);
}

// What renderers write there, 0 or 1, means nothing.
TEST(SelectSamples, ShadowOfTheBackgroundChangesNothing) {
  PlaneReadback readback = FloorWithVerticalEdge();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (x > 28 || (x > 15 && y < 5)) readback.depth[readback.Index(x, y)] = 1e10f;
    }
  }
  const SampleCounts counts = CountSamples(readback, kSun, SampleOptions());
  for (size_t i = 0; i < readback.depth.size(); ++i) {
    if (readback.depth[i] == 1e10f) readback.shadow_bits[i] ^= 1;
  }
  const SampleCounts turned = CountSamples(readback, kSun, SampleOptions());
  EXPECT_EQ(turned.candidates, counts.candidates);
  EXPECT_EQ(turned.background, counts.background);
  EXPECT_EQ(turned.used, counts.used);
  EXPECT_EQ(counts.used, 2 * (30 - 2 - 4));  // the edge at x = 20, and no outline
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

// A ridge between two planes, nearest to the camera at column 20: light from the left leaves the
// right side turned away. Shadow on the left ends there without an edge; within the left side it
// has one.
TEST(SelectSamples, TakesNoTerminatorForAnEdgeUnlessToldTo) {
  PlaneReadback readback = FloorReadback();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const double d = 0.25 - 0.006 * std::abs(x + 0.5 - 20.0);
      readback.depth[readback.Index(x, y)] = static_cast<float>(1.0 / d);
    }
  }
  const Light from_left = Light::Directional("left", {1.0, 0.2, -0.2});
  readback.Cast(0, [](int x, int) { return x < 20; });
  SampleOptions options;
  const SampleCounts terminator = CountSamples(readback, from_left, options);
  EXPECT_EQ(terminator.candidates, kNumCandidates);
  EXPECT_EQ(terminator.facing_away, kNumCandidates);
  options.use_terminators = true;
  const SampleCounts told_to = CountSamples(readback, from_left, options);
  EXPECT_EQ(told_to.facing_away, kNumCandidates / 2);
  EXPECT_EQ(told_to.used, kNumCandidates / 2);

  // Half of the shadow taken away: its lower end, 19 columns of two rows, is an edge.
  options.use_terminators = false;
  readback.shadow_bits.assign(readback.depth.size(), 0);
  readback.Cast(0, [](int x, int y) { return x < 20 && y < 15; });
  const SampleCounts with_edge = CountSamples(readback, from_left, options);
  EXPECT_EQ(with_edge.used, 2 * 19);
}

TEST(SelectSamples, CountsSurfacesEdgeOnToTheLight) {
  // 0.01 of the published method's 0.02 (SampleOptions::min_cos_light) above the horizon.
  const SampleCounts counts =
      CountSamples(FloorWithVerticalEdge(), Light::Directional("dusk", {1.0, 0.0, -0.01}));
  EXPECT_EQ(counts.edge_on, kNumCandidates);
  const SampleCounts above =
      CountSamples(FloorWithVerticalEdge(), Light::Directional("dawn", {1.0, 0.0, -0.03}));
  EXPECT_EQ(above.used, kNumCandidates);
}

TEST(SelectSamples, TakesSurfacesNearlyEdgeOnToTheLightWhenAsked) {
  SampleOptions options;
  options.min_cos_light = 0.001;
  const auto count = [&options](double height) {
    return CountSamples(
        FloorWithVerticalEdge(), Light::Directional("dusk", {1.0, 0.0, -height}), options);
  };
  EXPECT_EQ(count(0.01).used, kNumCandidates);
  EXPECT_EQ(count(0.0005).edge_on, kNumCandidates);
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
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  const Light lamp = Light::Point("lamp", surfaces.boundary[5].position);
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
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  for (const Light& light : {kSun, Light::Point("lamp", {1.0, 2.0, 4.0})}) {
    const Samples samples = SelectSamples(surfaces, light, surfaces.options, kLightSpace, false);
    ASSERT_EQ(samples.size(), surfaces.boundary.size());
    for (size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3d expected =
          RayFromWorld(light) * surfaces.boundary[i].position.homogeneous();
      EXPECT_LT(testing::HomogeneousError(samples.At(i).X, expected), 1e-6);
    }
  }
}

TEST(SelectSamples, KnowsEdgeNormalsOnlyWhenAsked) {
  const PlaneReadback readback = FloorWithVerticalEdge();
  const Surfaces with = *FindSurfaces(readback.View(), 1u, {});
  EXPECT_FALSE(SelectSamples(with, kSun, with.options, kLightSpace, false).has_edge_normals());
  const Samples samples = SelectSamples(with, kSun, with.options, kLightSpace, true);
  ASSERT_TRUE(samples.has_edge_normals());
  for (size_t i = 0; i < samples.size(); ++i) {
    EXPECT_THAT(samples.At(i).edge_normal, MatrixNear(Eigen::Vector2d(1.0, 0.0), 0.1));
  }
}

}  // namespace
}  // namespace lightfit
