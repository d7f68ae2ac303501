// Cover::kShadowed: the map has room for every shadowed surface, and lit ones that land in it too
// are not beyond its far end.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/affine_depth.h"
#include "geometry/convex_hull.h"
#include "optimizer/fit.h"
#include "optimizer/readback/cover.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::ExpectCovers;
using testing::FloorReadback;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::StatusIs;
using testing::TestScene;

struct Surface {
  Eigen::Vector3d position;
  bool is_shadowed;
};

std::vector<Surface> SurfacesOf(const Readback& readback, const Light& light) {
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  std::vector<Surface> surfaces;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
      if (!affine_depth.IsSurface(readback.depth[pixel])) continue;
      const Eigen::Vector4d screen(
          x + 0.5, y + 0.5, affine_depth.At(x, y, readback.depth[pixel]), 1.0);
      surfaces.push_back({(world_from_screen * screen).hnormalized(),
                          ((readback.shadow_bits[pixel] >> light.shadow_bit) & 1u) != 0});
    }
  }
  return surfaces;
}

// Calls check(light, surfaces, cover) for each light of some random scenes.
template <typename Check>
void ForEachCover(const Check& check) {
  int num_covers = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const TestScene scene(seed, 6, 160, 100);
    const Surfaces found = *FindSurfaces(scene.View(), 0x3f, {});
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const std::vector<Surface> surfaces = SurfacesOf(scene.View(), light);
      if (std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& surface) {
            return surface.is_shadowed;
          })) {
        continue;
      }
      const absl::StatusOr<RayCover> cover = CoverReceivers(found, light, Cover::kShadowed);
      ASSERT_THAT(cover, IsOk());
      check(light, surfaces, *cover);
      ++num_covers;
    }
  }
  EXPECT_GE(num_covers, 40);
}

TEST(CoverShadowed, HullIsExactlyThatOfAllShadowedPixels) {
  ForEachCover([](const Light& light, const std::vector<Surface>& surfaces, const RayCover& cover) {
    std::vector<Eigen::Vector2d> points;
    for (const Surface& surface : surfaces) {
      if (!surface.is_shadowed) continue;
      const Eigen::Vector3d ray =
          cover.normalized_from_ray * (RayFromWorld(light) * surface.position.homogeneous());
      EXPECT_GT(ray.z(), 0.0);
      points.push_back(ray.hnormalized());
    }
    // Coordinates fit the hull, so that absolute differences are relative ones.
    const Polygon exact = ConvexHull(points);
    EXPECT_NEAR(Area(cover.hull), Area(exact), 1e-9);
    for (const Eigen::Vector2d& vertex : cover.hull) {
      double distance = 1e300;
      for (const Eigen::Vector2d& point : points) {
        distance = std::min(distance, (vertex - point).norm());
      }
      EXPECT_LE(distance, 1e-9);
    }
  });
}

TEST(CoverShadowed, DepthIsNearOverTheShadowedAndFarOverAllCloseBy) {
  ForEachCover([](const Light& light, const std::vector<Surface>& surfaces, const RayCover& cover) {
    double near = 1e300, far = -1e300, far_of_all = -1e300, far_close_by = -1e300;
    for (const Surface& surface : surfaces) {
      const Eigen::Vector3d ray =
          cover.normalized_from_ray * (RayFromWorld(light) * surface.position.homogeneous());
      const double depth = light.kind == Light::Kind::kPoint
                               ? ray.z()
                               : surface.position.dot(light.direction.normalized());
      far_of_all = std::max(far_of_all, depth);
      const bool is_close_by = ray.z() > 0.0 && ray.hnormalized().cwiseAbs().maxCoeff() <= 4.0;
      if (is_close_by) far_close_by = std::max(far_close_by, depth);
      if (!surface.is_shadowed) continue;
      near = std::min(near, depth);
      far = std::max(far, depth);
    }
    const double rounding = 1e-9 * std::max(std::abs(near), std::abs(far_of_all));
    EXPECT_LE(cover.depth.near, near + rounding);
    EXPECT_GE(cover.depth.far, far - rounding);
    EXPECT_GE(cover.depth.far, far_close_by - rounding);
    // Tile corners reach further than their receivers, but not by more than the scene's extent.
    const double extent = far_of_all - near;
    EXPECT_GE(cover.depth.near, near - 1.5 * extent);
    EXPECT_LE(cover.depth.far, far_of_all + 1.5 * extent);
    if (light.kind == Light::Kind::kPoint) {
      EXPECT_GT(cover.depth.near, 0.0);
    }
  });
}

void ExpectSameCover(const RayCover& a, const RayCover& b) {
  EXPECT_EQ(a.normalized_from_ray, b.normalized_from_ray);
  EXPECT_EQ(a.hull, b.hull);
  EXPECT_EQ(a.mean_ray, b.mean_ray);
  EXPECT_EQ(a.depth.near, b.depth.near);
  EXPECT_EQ(a.depth.far, b.depth.far);
}

const Light kSun = Light::Directional("sun", {0.3, 0.2, -1.0}, 2);
const Light kLamp = Light::Point("lamp", {0.5, -0.5, 2.0}, 2);

// None at all, or of another light.
TEST(CoverShadowed, WithoutShadowEveryReceiverIsCovered) {
  std::vector<PlaneReadback> readbacks(2, FloorReadback());
  readbacks[1].Cast(0, [](int x, int) { return x > 20; });
  for (const PlaneReadback& readback : readbacks) {
    const Surfaces surfaces = *FindSurfaces(readback.View(), 1u << 2, {});
    for (const Light& light : {kSun, kLamp}) {
      const auto all = CoverReceivers(surfaces, light, Cover::kReceivers);
      const auto shadowed = CoverReceivers(surfaces, light, Cover::kShadowed);
      ASSERT_THAT(all, IsOk());
      ASSERT_THAT(shadowed, IsOk());
      EXPECT_TRUE(shadowed->nothing_to_cover);
      ExpectSameCover(*shadowed, *all);
    }
  }
}

// The centres of one pixel, of two, of a row have no area; the edges of their shadow lie within a
// pixel of them.
TEST(CoverShadowed, OfShadowsWithoutAnAreaTheHullReachesAPixelFurther) {
  constexpr double kRounding = 1e-9;
  const std::vector<std::vector<Eigen::Vector2i>> shadows = {
      {{7, 9}}, {{7, 9}, {12, 20}}, {{0, 9}, {1, 9}, {2, 9}, {3, 9}}};
  for (const std::vector<Eigen::Vector2i>& pixels : shadows) {
    SCOPED_TRACE(pixels.size());
    PlaneReadback readback = FloorReadback();
    readback.Cast(2, [&pixels](int x, int y) {
      return std::find(pixels.begin(), pixels.end(), Eigen::Vector2i(x, y)) != pixels.end();
    });
    const Surfaces surfaces = *FindSurfaces(readback.View(), 1u << 2, {});
    for (const Light& light : {kSun, kLamp}) {
      const auto cover = CoverReceivers(surfaces, light, Cover::kShadowed);
      ASSERT_THAT(cover, IsOk());
      EXPECT_FALSE(cover->nothing_to_cover);
      std::vector<Eigen::Vector2d> corners;
      for (const Eigen::Vector2i& pixel : pixels) {
        const double d = surfaces.affine_depth.At(
            pixel.x(), pixel.y(), readback.depth[readback.Index(pixel.x(), pixel.y())]);
        for (const double dx : {-1.0, 1.0}) {
          for (const double dy : {-1.0, 1.0}) {
            const Eigen::Vector4d screen(pixel.x() + 0.5 + dx, pixel.y() + 0.5 + dy, d, 1.0);
            corners.emplace_back((cover->normalized_from_ray * RayFromWorld(light) *
                                  surfaces.world_from_screen * screen)
                                     .hnormalized());
          }
        }
      }
      const Polygon expected = ConvexHull(corners);
      EXPECT_NEAR(Area(cover->hull), Area(expected), kRounding);
      for (const Eigen::Vector2d& vertex : cover->hull) {
        EXPECT_TRUE(
            std::any_of(corners.begin(), corners.end(), [&vertex](const Eigen::Vector2d& corner) {
              return (vertex - corner).norm() < kRounding;
            }));
      }
    }
  }
}

TEST(CoverShadowed, OfAnImageAllInShadowIsThatOfAllReceivers) {
  PlaneReadback readback = FloorReadback();
  readback.Cast(2, [](int, int) { return true; });
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u << 2, {});
  for (const Light& light : {kSun, kLamp}) {
    const auto all = CoverReceivers(surfaces, light, Cover::kReceivers);
    const auto shadowed = CoverReceivers(surfaces, light, Cover::kShadowed);
    ASSERT_THAT(all, IsOk());
    ASSERT_THAT(shadowed, IsOk());
    ExpectSameCover(*shadowed, *all);
  }
}

// A bumpy floor with a lamp between its heights: receivers all around, shadows on one side.
TEST(CoverShadowed, LightAmongReceiversHasAMapWhereItsShadowsLieToOneSide) {
  PlaneReadback readback = FloorReadback();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      readback.depth[readback.Index(x, y)] *= (x + y) % 2 == 0 ? 0.97f : 1.03f;
    }
  }
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 0.0}, 2);
  const auto shadow_from = [&](int first_column) {
    readback.shadow_bits.assign(readback.depth.size(), 0);
    readback.Cast(2, [first_column](int x, int y) {
      return x >= first_column && std::hypot(x - 32.0, y - 15.0) < 12.0;
    });
  };
  shadow_from(26);
  const Surfaces surfaces = *FindSurfaces(readback.View(), 1u << 2, {});
  EXPECT_THAT(CoverReceivers(surfaces, lamp, Cover::kReceivers),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("light \"lamp\"")));
  const auto cover = CoverReceivers(surfaces, lamp, Cover::kShadowed);
  ASSERT_THAT(cover, IsOk());
  EXPECT_GT(cover->depth.near, 0.0);
  FitOptions focused;
  focused.search = Search::kFocused;
  for (const FitOptions& options : {FitOptions(), focused}) {
    const auto matrix = FitLight(readback.View(), lamp, {256, 256}, options);
    ASSERT_THAT(matrix, IsOk());
    testing::ExpectAllFinite(*matrix);
    ExpectCovers(*matrix, readback.View(), lamp, Cover::kShadowed);
  }
  readback.shadow_bits.assign(readback.depth.size(), 0);
  readback.Cast(2, [](int, int) { return true; });
  EXPECT_THAT(FitLight(readback.View(), lamp, {256, 256}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("light \"lamp\"")));
}

// Few small shadows on a wide floor: most of what the map's corners see is lit and far from them.
TEST(CoverShadowed, LitReceiversInTheMapAreNotBeyondItsFarEnd) {
  int num_fitted = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    BoxSceneOptions options;
    options.num_boxes = 1 + static_cast<int>(seed % 4);
    options.floor_half_size = seed % 2 == 0 ? 60.0 : 200.0;
    const BoxScene scene = MakeBoxScene(seed, options);
    std::vector<Light> lights = RandomLights(scene, seed, 6);
    for (size_t i = 1; i < lights.size(); i += 3) lights[i].position.z() = 1.0 + 0.5 * i;  // low
    const SyntheticReadback readback = Render(scene, RandomCamera(scene, seed, 96, 64), lights);
    const auto matrices = FitLights(readback.View(), lights, {512, 512});
    for (size_t i = 0; i < lights.size(); ++i) {
      if (!matrices[i].ok()) continue;
      ExpectCovers(*matrices[i], readback.View(), lights[i]);
      ++num_fitted;
    }
  }
  EXPECT_GE(num_fitted, 60);
}

// Room for shadows only is less than room for everything: texels are never larger.
TEST(CoverShadowed, FocusedMapsAreNeverLarger) {
  FitOptions shadowed, all;
  shadowed.search = all.search = Search::kFocused;
  all.cover = Cover::kReceivers;
  int num_compared = 0, num_smaller = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 6);
    for (const Light& light : scene.lights) {
      if (light.kind != Light::Kind::kDirectional) continue;  // the same axis either way
      const auto a = FitLight(scene.View(), light, {512, 512}, shadowed);
      const auto b = FitLight(scene.View(), light, {512, 512}, all);
      if (!a.ok() || !b.ok()) continue;
      EXPECT_LE(a->figures.energy, b->figures.energy * (1.0 + 1e-9))
          << light.name << ", seed " << seed;
      ++num_compared;
      num_smaller += static_cast<int>(a->figures.energy < 0.9 * b->figures.energy);
    }
  }
  EXPECT_GE(num_compared, 10);
  EXPECT_GE(num_smaller, 3);
}

}  // namespace
}  // namespace lightfit
