// Border::kDark: the map has room for every lit surface, and all that lands in it is in its range
// of depth. The finer cover, with either border.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "geometry/affine_depth.h"
#include "geometry/convex_hull.h"
#include "optimizer/fit.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/needed_surfaces.h"
#include "tests/testing/fine_image.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::FineImage;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {512, 384};

struct Seen {
  Eigen::Vector3d position;
  bool is_dark, is_lit;
};

// Every surface, by the bits alone.
std::vector<Seen> AllSeen(const Readback& readback, const Light& light) {
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  std::vector<Seen> all;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t i = readback.Index(x, y);
      if (!affine_depth.IsSurface(readback.depth[i])) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, readback.depth[i]), 1.0);
      const bool faces = ((readback.facing_bits[i] >> light.shadow_bit) & 1u) != 0;
      const bool blocked = ((readback.shadow_bits[i] >> light.shadow_bit) & 1u) != 0;
      all.push_back(
          {(world_from_screen * screen).hnormalized(), faces && blocked, faces && !blocked});
    }
  }
  return all;
}

// Calls check(view, light) for lights of random scenes that light and shadow something.
template <typename Check>
void ForEachLight(const Check& check) {
  int num_lights = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 6, 160, 100);
    const Readback view = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const std::vector<Seen> seen = AllSeen(view, light);
      const auto num_lit =
          std::count_if(seen.begin(), seen.end(), [](const Seen& s) { return s.is_lit; });
      if (num_lit < 20) continue;
      check(view, light);
      ++num_lights;
    }
  }
  EXPECT_GE(num_lights, 25);
}

TEST(CoverDark, HullIsExactlyThatOfAllLitPixels) {
  ForEachLight([](const Readback& readback, const Light& light) {
    const Surfaces surfaces = *FindSurfaces(readback, uint32_t{1} << light.shadow_bit, {});
    const auto cover = CoverReceivers(surfaces, light, Cover::kShadowed, Border::kDark);
    ASSERT_THAT(cover, IsOk());
    EXPECT_EQ(cover->border, Border::kDark);
    std::vector<Eigen::Vector2d> points;
    for (const Seen& seen : AllSeen(readback, light)) {
      if (!seen.is_lit) continue;
      const Eigen::Vector3d ray =
          cover->normalized_from_ray * (RayFromWorld(light) * seen.position.homogeneous());
      EXPECT_GT(ray.z(), 0.0);
      points.push_back(ray.hnormalized());
    }
    EXPECT_NEAR(Area(cover->hull), Area(ConvexHull(points)), 1e-9);
  });
}

// What the border answers wrongly is in the map; of all that lands in it dark surfaces are not cut
// by the near plane, where a look-up would find them lit, nor anything by the far one.
TEST(CoverDark, MapsHaveRoomForAllThatIsLitAndDepthForAllThatLandsInThem) {
  FitOptions options;
  options.border = BorderChoice::kDark;
  ForEachLight([&](const Readback& readback, const Light& light) {
    const auto fit = FitLight(readback, light, kMap, options);
    ASSERT_THAT(fit, IsOk());
    EXPECT_EQ(fit->border, Border::kDark);
    EXPECT_EQ(fit->facing, FacingSource::kGiven);
    testing::ExpectAllFinite(*fit);
    constexpr double kTolerance = 1e-6;
    for (const Seen& seen : AllSeen(readback, light)) {
      const Eigen::Vector4d map = fit->map_from_world * seen.position.homogeneous();
      const Eigen::Vector3d texel = map.hnormalized();
      const bool is_inside = map.w() > 0.0 && texel.x() >= -kTolerance &&
                             texel.x() <= kMap.width + kTolerance && texel.y() >= -kTolerance &&
                             texel.y() <= kMap.height + kTolerance;
      EXPECT_TRUE(is_inside || !seen.is_lit) << texel.transpose();
      if (!is_inside) continue;
      EXPECT_LE(texel.z(), 1.0 + kTolerance);
      // Beside a lamp there is no nearest surface; suns have one.
      if (light.kind == Light::Kind::kDirectional || seen.is_lit) {
        EXPECT_GE(texel.z(), -kTolerance);
      }
    }
  });
}

TEST(CoverDark, SamplesFarOutsideAreLeftOutAndCounted) {
  int64_t num_beyond = 0;
  ForEachLight([&](const Readback& readback, const Light& light) {
    const Surfaces surfaces = *FindSurfaces(readback, uint32_t{1} << light.shadow_bit, {});
    FitOptions options, everywhere;
    everywhere.cover = Cover::kReceivers;
    const auto lit = ViewLight(surfaces, light, Border::kLit, options);
    const auto dark = ViewLight(surfaces, light, Border::kDark, options);
    const auto all = ViewLight(surfaces, light, Border::kDark, everywhere);
    ASSERT_THAT(lit, IsOk());
    ASSERT_THAT(dark, IsOk());
    ASSERT_THAT(all, IsOk());
    const SampleCounts& of_dark = dark->samples.counts;
    EXPECT_EQ(of_dark.used + of_dark.beyond_map, all->samples.counts.used);
    EXPECT_EQ(all->samples.counts.beyond_map, 0);
    EXPECT_EQ(lit->samples.counts.beyond_map, 0);
    EXPECT_EQ(of_dark.used, static_cast<int64_t>(dark->samples.size()));
    for (size_t i = 0; i < dark->samples.size(); ++i) {
      const Eigen::Vector3d X = dark->samples.At(i).X;
      EXPECT_GT(X.z(), 0.0);
      EXPECT_LE(X.hnormalized().cwiseAbs().maxCoeff(), kSquaresServed + 1e-12);
    }
    num_beyond += of_dark.beyond_map;
  });
  EXPECT_GT(num_beyond, 10);
}

// Without the third state what is lit is guessed from normals: mostly right on boxes.
TEST(NeededSurfaces, GuessedFromNormalsAgreeWithTheThirdStateButForCreasesAndTheImagesBorder) {
  int64_t num_pixels = 0, num_other = 0;
  ForEachLight([&](const Readback& readback, const Light& light) {
    Readback without = readback;
    without.facing_bits = {};
    const uint32_t bit = uint32_t{1} << light.shadow_bit;
    const Surfaces surfaces = *FindSurfaces(readback, bit, {});
    const Surfaces surfaces_without = *FindSurfaces(without, bit, {});
    const NeededSurfaces lit(surfaces, light, Border::kDark);
    const NeededSurfaces guessed_lit(surfaces_without, light, Border::kDark);
    const auto given = lit.words(), guessed = guessed_lit.words();
    for (size_t i = 0; i < given.size(); ++i) {
      if (!(readback.depth[i] < kSyntheticBackground)) continue;
      ++num_pixels;
      num_other += ((given[i] ^ guessed[i]) & bit) != 0 ? 1 : 0;
    }
  });
  std::printf("%d of %d pixels guessed wrongly\n",
              static_cast<int>(num_other),
              static_cast<int>(num_pixels));
  EXPECT_LT(static_cast<double>(num_other), 0.01 * static_cast<double>(num_pixels));
}

TEST(CoverDark, WhereNothingIsLitEveryReceiverIsCovered) {
  const TestScene scene(2, 3);
  Readback view = scene.readback.ViewWithFacing();
  const std::vector<uint32_t> all_dark(view.shadow_bits.size(), ~0u);
  view.shadow_bits = all_dark;
  const Surfaces surfaces = *FindSurfaces(view, 1u, {});
  const auto dark = CoverReceivers(surfaces, scene.lights[0], Cover::kShadowed, Border::kDark);
  const auto all = CoverReceivers(surfaces, scene.lights[0], Cover::kReceivers);
  ASSERT_THAT(dark, IsOk());
  EXPECT_TRUE(dark->nothing_to_cover);
  EXPECT_EQ(dark->normalized_from_ray, all->normalized_from_ray);
}

// Nothing that the border answers wrongly lies outside, not even what only the finer image shows;
// and without it some does, or this would show nothing.
TEST(FineCover, MapsHaveRoomForWhatOnlyTheFinerImageShows) {
  int64_t num_outside_without = 0;
  for (uint64_t seed = 21; seed <= 26; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const std::vector<Light> lights = RandomLights(scene, seed, 3);
    const SyntheticReadback coarse = Render(scene, RandomCamera(scene, seed, 60, 40), lights);
    const SyntheticReadback fine = Render(scene, RandomCamera(scene, seed, 480, 320), lights);
    const FineImage image(fine, 1);
    for (const Light& light : lights) {
      for (const Border border : {Border::kLit, Border::kDark}) {
        SCOPED_TRACE(light.name + ", seed " + std::to_string(seed) + ", " + BorderName(border));
        FitOptions options;
        options.border = border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
        options.margin_percent = 0.0;
        Readback view = coarse.ViewWithFacing();
        const auto without = FitLight(view, light, kMap, options);
        view.fine_cover = &image.cover;
        const auto with = FitLight(view, light, kMap, options);
        if (!without.ok()) continue;
        ASSERT_THAT(with, IsOk());
        const auto num_outside = [&](const LightMatrix& matrix) {
          int64_t count = 0;
          for (const Seen& seen : AllSeen(fine.ViewWithFacing(), light)) {
            if (!(border == Border::kDark ? seen.is_lit : seen.is_dark)) continue;
            const Eigen::Vector4d map = matrix.map_from_world * seen.position.homogeneous();
            const Eigen::Vector2d texel = map.head<2>() / map.w();
            const bool is_inside = map.w() > 0.0 && texel.minCoeff() >= -1e-6 &&
                                   texel.x() <= kMap.width + 1e-6 &&
                                   texel.y() <= kMap.height + 1e-6;
            count += is_inside ? 0 : 1;
          }
          return count;
        };
        EXPECT_EQ(num_outside(*with), 0);
        num_outside_without += num_outside(*without);
      }
    }
  }
  std::printf("without it %d pixels of the finer images lie outside\n",
              static_cast<int>(num_outside_without));
  EXPECT_GT(num_outside_without, 100);
}

// Cells of several pixels cover what their pixels do, but for the pixels' places in the cell.
TEST(FineCover, ReducedCellsLeaveOutHalfACellAtMost) {
  const BoxScene scene = MakeBoxScene(23);
  const std::vector<Light> lights = RandomLights(scene, 23, 3);
  const SyntheticReadback coarse = Render(scene, RandomCamera(scene, 23, 60, 40), lights);
  const SyntheticReadback fine = Render(scene, RandomCamera(scene, 23, 480, 320), lights);
  const FineImage exact(fine, 1), reduced(fine, 2);
  for (const Light& light : lights) {
    Readback view = coarse.ViewWithFacing();
    const auto area = [&](const FineCover& cover) {
      view.fine_cover = &cover;
      const Surfaces surfaces = *FindSurfaces(view, uint32_t{1} << light.shadow_bit, {});
      const auto rays =
          CoverReceivers(surfaces, light, Cover::kShadowed, Border::kLit, /*use_fine_cover=*/true);
      EXPECT_THAT(rays, IsOk());
      // In light space, whatever the coordinates of either.
      std::vector<Eigen::Vector2d> hull;
      for (const Eigen::Vector2d& vertex : rays->hull) {
        const Eigen::Vector3d ray = rays->normalized_from_ray.inverse() * vertex.homogeneous();
        hull.push_back(ray.hnormalized());
      }
      return Area(ConvexHull(hull));
    };
    EXPECT_GT(area(reduced.cover), 0.95 * area(exact.cover)) << light.name;
  }
}

TEST(FineCover, SizesThatDoNotBelongTogetherAreNamed) {
  const TestScene scene(2, 1);
  Readback view = scene.View();
  const std::vector<float> depth(12, 1.0f);
  const std::vector<uint32_t> bits(11, 0);
  FineCover cover;
  cover.columns = 4;
  cover.rows = 3;
  cover.nearest = depth;
  cover.shadow_bits = bits;
  view.fine_cover = &cover;
  EXPECT_THAT(ValidateReadback(view),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("readback.fine_cover.shadow_bits: 11 values, want 4 x 3 = 12")));
}

}  // namespace
}  // namespace lightfit
