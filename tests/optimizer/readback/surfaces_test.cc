#include "optimizer/readback/surfaces.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "geometry/affine_depth.h"
#include "optimizer/readback/samples.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::DepthOnPlane;
using testing::FloorReadback;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::Random;
using testing::StatusIs;

constexpr DepthKind kAllKinds[] = {DepthKind::kCameraZ,
                                   DepthKind::kDistance,
                                   DepthKind::kNdcZeroToOne,
                                   DepthKind::kNdcMinusOneToOne,
                                   DepthKind::kNdcReversedZeroToOne};

// A plane that a camera around the origin sees over its whole image, not edge-on.
struct PlaneView {
  Camera camera;
  Eigen::Vector3d normal;
  double offset;
};

PlaneView RandomPlaneView(Random& random, bool orthographic) {
  while (true) {
    PlaneView view;
    view.camera = testing::CameraAround(random, 1.0, orthographic);
    view.camera.near = 0.4;
    view.camera.far = 12.0;
    view.normal = random.UnitVector();
    view.offset = random.Uniform(-0.2, 0.2);
    bool visible = true;
    for (const int x : {0, view.camera.width}) {
      for (const int y : {0, view.camera.height}) {
        const double d = DepthOnPlane(view.camera, view.normal, view.offset, {x, y})(0);
        const double z = orthographic ? d : 1.0 / d;
        visible &= z > 0.5 && z < 10.0;
      }
    }
    if (visible) return view;
  }
}

// math.md (11): central differences of affine depth are exact on planes, to the rounding of the
// float depth, whatever the kind.
TEST(DepthGradientAt, IsExactOnPlanesForEveryKind) {
  Random random(151);
  for (int i = 0; i < 60; ++i) {
    const bool orthographic = i % 2 == 1;
    const PlaneView view = RandomPlaneView(random, orthographic);
    for (const DepthKind kind : kAllKinds) {
      const PlaneReadback readback(view.camera, kind, view.normal, view.offset);
      const AffineDepth affine_depth(view.camera, kind);
      SampleOptions options;
      options.use_outlines = false;
      options.max_depth_bend = 1.0;
      for (int k = 0; k < 10; ++k) {
        const int x = random.Int(1, view.camera.width - 2),
                  y = random.Int(1, view.camera.height - 2);
        const Eigen::Vector3d exact =
            DepthOnPlane(view.camera, view.normal, view.offset, {x + 0.5, y + 0.5});
        DepthGradient gradient;
        if (!DepthGradientAt(readback.View(), affine_depth, options, x, y, &gradient)) continue;
        // Half a unit in the last place of a float, for values up to d, or up to 1 in NDC.
        const double ndc_scale = orthographic ? view.camera.far : 1.0 / view.camera.near;
        const double rounding =
            0x1p-23 * (kind == DepthKind::kCameraZ || kind == DepthKind::kDistance
                           ? std::abs(exact(0))
                           : ndc_scale);
        EXPECT_NEAR(gradient.d, exact(0), rounding) << DepthKindName(kind);
        EXPECT_NEAR(gradient.d_x, exact(1), rounding) << DepthKindName(kind);
        EXPECT_NEAR(gradient.d_y, exact(2), rounding) << DepthKindName(kind);
      }
    }
  }
}

TEST(DepthGradientAt, AcceptsPlanesOfEveryKindAlmostEverywhere) {
  Random random(152);
  for (int i = 0; i < 20; ++i) {
    const PlaneView view = RandomPlaneView(random, i % 2 == 1);
    for (const DepthKind kind : kAllKinds) {
      const PlaneReadback readback(view.camera, kind, view.normal, view.offset);
      const AffineDepth affine_depth(view.camera, kind);
      SampleOptions options;
      options.use_outlines = false;
      int num_accepted = 0;
      for (int y = 1; y + 1 < view.camera.height; ++y) {
        for (int x = 1; x + 1 < view.camera.width; ++x) {
          DepthGradient gradient;
          num_accepted += static_cast<int>(
              DepthGradientAt(readback.View(), affine_depth, options, x, y, &gradient));
        }
      }
      const int num_inner = (view.camera.width - 2) * (view.camera.height - 2);
      EXPECT_GE(num_accepted, num_inner * 99 / 100) << DepthKindName(kind);
    }
  }
}

TEST(SurfaceNormal, IsThePlanesNormalTowardsTheEye) {
  Random random(153);
  for (int i = 0; i < 100; ++i) {
    const bool orthographic = i % 2 == 1;
    const PlaneView view = RandomPlaneView(random, orthographic);
    const Eigen::Vector3d exact = DepthOnPlane(view.camera, view.normal, view.offset, {10.5, 12.5});
    const Eigen::Vector3d normal = SurfaceNormal(
        view.camera.ScreenFromWorld(), orthographic, 10, 12, {exact(0), exact(1), exact(2)});
    EXPECT_NEAR(std::abs(normal.dot(view.normal)), 1.0, 1e-12);
    const Eigen::Vector3d forward = view.camera.camera_from_world.block<1, 3>(2, 0).transpose();
    const Eigen::Vector3d at_pixel =
        (view.camera.WorldFromScreen() * Eigen::Vector4d(10.5, 12.5, exact(0), 1.0)).hnormalized();
    const Eigen::Vector3d eye = view.camera.camera_from_world.inverse().topRightCorner<3, 1>();
    const Eigen::Vector3d to_eye =
        orthographic ? Eigen::Vector3d(-forward) : Eigen::Vector3d(eye - at_pixel);
    EXPECT_GT(normal.dot(to_eye), 0.0);
  }
}

TEST(FindSurfaces, TilesAreThoseOfAllReceivers) {
  const testing::TestScene scene(2, 1, 323, 177);
  const Surfaces surfaces = *FindSurfaces(scene.View(), 1u, {});
  EXPECT_EQ(surfaces.counts[0].invalid_depth, 0);
  EXPECT_EQ(surfaces.tiles.filter.mask, 0u);
  EXPECT_EQ(surfaces.tiles.num_surfaces, surfaces.counts[0].receivers);
  EXPECT_EQ(surfaces.tiles.num_surfaces + surfaces.tiles.num_background, 323 * 177);
}

// Outlines are marked, so that one pass serves samples with them and without: those are the pixels
// for which no gradient is known without a side; the others have the gradient they have without.
TEST(FindSurfaces, MarksOutlinesForThoseWhoDoNotWantThem) {
  SampleOptions without;
  without.use_outlines = false;
  int64_t num_outlines = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const testing::TestScene scene(seed, 3);
    const Surfaces surfaces = *FindSurfaces(scene.View(), 7u, without);
    for (const BoundaryPixel& pixel : surfaces.boundary) {
      DepthGradient gradient;
      const bool continues = DepthGradientAt(
          scene.View(), surfaces.affine_depth, without, pixel.x, pixel.y, &gradient);
      EXPECT_NE(continues, pixel.is_outline);
      num_outlines += pixel.is_outline ? 1 : 0;
      if (!continues) continue;
      EXPECT_EQ(gradient.d_x, pixel.d_x);
      EXPECT_EQ(gradient.d_y, pixel.d_y);
    }
    for (const Light& light : scene.lights) {
      const Eigen::Matrix3d light_space = Eigen::Matrix3d::Identity();
      const SampleCounts with_counts =
          SelectSamples(surfaces, light, {}, light_space, false).counts;
      const SampleCounts counts =
          SelectSamples(surfaces, light, without, light_space, false).counts;
      EXPECT_EQ(with_counts.candidates, counts.candidates);
      EXPECT_LE(with_counts.discontinuity, counts.discontinuity / 10);
      EXPECT_EQ(counts.used,
                counts.candidates - counts.background - counts.discontinuity - counts.facing_away -
                    counts.edge_on);
    }
  }
  EXPECT_GE(num_outlines, 500);
}

TEST(FindSurfaces, BoundaryIsTheSameWhateverOtherLightsAreAskedFor) {
  const testing::TestScene scene(5, 6);
  const Surfaces all = *FindSurfaces(scene.View(), 0x3f, {});
  for (int bit = 0; bit < 6; ++bit) {
    const Surfaces one = *FindSurfaces(scene.View(), 1u << bit, {});
    int64_t num_in_all = 0;
    for (const BoundaryPixel& pixel : all.boundary) num_in_all += (pixel.lights >> bit) & 1u;
    EXPECT_EQ(num_in_all, static_cast<int64_t>(one.boundary.size()));
    EXPECT_EQ(all.counts[bit].candidates, one.counts[bit].candidates);
    EXPECT_EQ(all.counts[bit].discontinuity, one.counts[bit].discontinuity);
  }
}

TEST(FindSurfaces, OutermostPixelsAreNeverBoundary) {
  PlaneReadback readback = FloorReadback();
  readback.Cast(0, [](int x, int y) { return (x + y) % 2 == 0; });
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, {});
  EXPECT_EQ(surfaces.counts[0].candidates, 38 * 28);
  for (const BoundaryPixel& pixel : surfaces.boundary) {
    EXPECT_GE(pixel.x, 1);
    EXPECT_GE(pixel.y, 1);
    EXPECT_LE(pixel.x, 38);
    EXPECT_LE(pixel.y, 28);
  }
}

TEST(FindSurfaces, ImagesWithoutInnerPixelsHaveNoBoundary) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 2), std::pair(40, 1)}) {
    PlaneReadback readback = FloorReadback(testing::FloorCamera(width, height));
    readback.Cast(0, [](int x, int) { return x % 2 == 0; });
    const absl::StatusOr<Surfaces> surfaces = FindSurfaces(readback.View(), 1u, {});
    ASSERT_THAT(surfaces, IsOk());
    EXPECT_TRUE(surfaces->boundary.empty());
  }
}

TEST(FindSurfaces, RejectsDepthWithoutAnySurface) {
  PlaneReadback readback = FloorReadback();
  readback.depth.assign(readback.depth.size(), 1e10f);
  EXPECT_THAT(FindSurfaces(readback.View(), 1u, {}),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("readback.depth: all 1200 pixels are background")));
  readback.depth.assign(readback.depth.size(), -1.0f);
  EXPECT_THAT(FindSurfaces(readback.View(), 1u, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("1200 of 1200 pixels")));
}

}  // namespace
}  // namespace lightfit
