// Plans of a read-back with a finer cover.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>

#include "geometry/affine_depth.h"
#include "optimizer/readback/fine_surfaces.h"
#include "partition/evaluate_plan.h"
#include "partition/fit_plan.h"
#include "partition/served_rays.h"
#include "partition/sphere_cells.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/receivers.h"
#include "tests/testing/fine_image.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::FineImage;
using testing::IsOk;
using testing::kDepthRounding;
using testing::kTexelRounding;

constexpr int64_t kTexels = int64_t{200} * 200;

// A random scene in two sizes of one picture.
struct Pictures {
  BoxScene scene;
  std::vector<Light> lights;
  SyntheticReadback coarse;
  FineImage fine;
  Readback readback;

  explicit Pictures(uint64_t seed, int block = 1)
      : scene(MakeBoxScene(seed)),
        lights(RandomLights(scene, seed, 3)),
        coarse(Render(scene, RandomCamera(scene, seed, 60, 40), lights)),
        fine(Render(scene, RandomCamera(scene, seed, 480, 320), lights), block),
        readback(coarse.ViewWithFacing()) {
    readback.fine_cover = &fine.cover;
  }
  Pictures(const Pictures&) = delete;

  Surfaces Found(bool is_fine = true) const {
    Readback view = readback;
    if (!is_fine) view.fine_cover = nullptr;
    return *FindSurfaces(view, 0x7, {});
  }
};

PlanOptions OptionsOf(Border border, bool choose = false) {
  PlanOptions options;
  options.max_maps = 3;
  options.texels = kTexels;
  options.choose_by_forecast = choose;
  options.fit.border = border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
  return options;
}

// Cells that the border answers wrongly, at either depth: how many no map holds, and how many are
// out of the depths of the map that they ask.
struct LostCells {
  int64_t outside = 0, out_of_depth = 0;
};

LostCells CountLost(const Surfaces& surfaces,
                    const Light& light,
                    const Plan& plan,
                    double guard_texels = 0.0) {
  LostCells lost;
  const auto look_up =
      PlanLookUp::Create(plan, light, std::max(0.0, guard_texels - kTexelRounding));
  EXPECT_THAT(look_up, IsOk());
  if (!look_up.ok()) return lost;
  for (const FineSurfaces& fine : FindFineSurfaces(surfaces, light, plan.border)) {
    fine.ForEach([&](const Eigen::Vector4d& cell) {
      const Eigen::Vector3d world = (fine.surfaces.world_from_screen * cell).hnormalized();
      const int map = look_up->At(world).map;
      lost.outside += map < 0 ? 1 : 0;
      if (map < 0) return;
      const Eigen::Vector4d at = plan.maps[map].map_from_world * world.homogeneous();
      const double depth = at.z() / at.w();
      lost.out_of_depth += depth < -kDepthRounding || depth > 1.0 + kDepthRounding ? 1 : 0;
    });
  }
  return lost;
}

// Nothing that the border answers wrongly lies outside of all maps, not even what only the finer
// image shows; and without it some does, or this would show nothing.
TEST(FinePlans, HaveRoomForWhatOnlyTheFinerImageShows) {
  int64_t num_lost_without = 0, num_several = 0;
  for (uint64_t seed = 21; seed <= 23; ++seed) {
    // Cells of one pixel, or of four with two depths.
    const Pictures pictures(seed, seed % 2 == 0 ? 2 : 1);
    const Surfaces surfaces = pictures.Found();
    for (const Light& light : pictures.lights) {
      for (const Border border : {Border::kLit, Border::kDark}) {
        SCOPED_TRACE(light.name + ", seed " + std::to_string(seed) + ", " + BorderName(border));
        PlanOptions options = OptionsOf(border);
        options.fit.margin_percent = 0.0;
        options.guard_texels = 1.0;
        const auto with = FitPlan(surfaces, light, options);
        options.fit.use_fine_cover = false;
        const auto without = FitPlan(surfaces, light, options);
        if (!without.ok()) continue;
        ASSERT_THAT(with, IsOk());
        for (const LightMatrix& map : with->maps) testing::ExpectAllFinite(map);
        EXPECT_LE(NumTexels(PlanOf(*with)), kTexels);
        const LostCells lost = CountLost(surfaces, light, PlanOf(*with), options.guard_texels);
        EXPECT_EQ(lost.outside, 0);
        EXPECT_EQ(lost.out_of_depth, 0);
        num_several += with->maps.size() > 1 ? 1 : 0;
        num_lost_without +=
            CountLost(surfaces, light, PlanOf(*without), options.guard_texels).outside;
      }
    }
  }
  std::printf("without it %d cells lie outside\n", static_cast<int>(num_lost_without));
  EXPECT_GT(num_lost_without, 100);
  EXPECT_GT(num_several, 10);
}

TEST(FinePlans, AreTakenWhereTheyAreForetoldToBeBetter) {
  int num_fine = 0, num_coarse = 0;
  for (uint64_t seed = 21; seed <= 22; ++seed) {
    const Pictures pictures(seed);
    const Surfaces surfaces = pictures.Found();
    for (const Light& light : pictures.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      PlanOptions options = OptionsOf(Border::kLit, /*choose=*/true);
      const auto chosen = FitPlan(surfaces, light, options);
      ASSERT_THAT(chosen, IsOk());
      options.fit.use_fine_cover = false;
      const auto coarse = FitPlan(surfaces, light, options);
      ASSERT_THAT(coarse, IsOk());
      EXPECT_LE(*chosen->wrong_share, *coarse->wrong_share);
      EXPECT_EQ(*chosen->wrong_share,
                *ForetellPlan(pictures.readback, light, PlanOf(*chosen), options.fit.samples));
      const bool is_coarse = chosen->maps.size() == coarse->maps.size() &&
                             chosen->maps[0].map_from_world == coarse->maps[0].map_from_world;
      ++(is_coarse ? num_coarse : num_fine);
    }
  }
  std::printf("%d fine, %d coarse\n", num_fine, num_coarse);
  EXPECT_GE(num_fine, 2);
  EXPECT_GE(num_coarse, 1);
}

// Rays to be covered and nothing else: the pixels, the samples and the bins of both stay.
TEST(FinePlans, ServeTheSamplesOfTheReadBackAlone) {
  int num_bins = 0;
  for (uint64_t seed = 21; seed <= 23; ++seed) {
    const Pictures pictures(seed);
    const Surfaces surfaces = pictures.Found();
    for (const Light& light : pictures.lights) {
      FitOptions fit;
      fit.border = BorderChoice::kLit;
      const auto view = ViewLight(surfaces, light, Border::kLit, fit);
      ASSERT_THAT(view, IsOk());
      const ServedRays with = *FindServedRays(*view, fit);
      fit.use_fine_cover = false;
      const ServedRays without = *FindServedRays(*view, fit);
      EXPECT_EQ(with.pixels, without.pixels);
      EXPECT_EQ(with.num_covered, without.num_covered);
      EXPECT_EQ(with.num_boundary, without.num_boundary);
      ASSERT_EQ(with.samples.size(), without.samples.size());
      ASSERT_GE(with.bins.size(), without.bins.size());
      EXPECT_LE(with.bins.size(), without.bins.size() + ServedRaysOptions().max_fine_bins);
      for (size_t i = 0; i < without.bins.size(); ++i) {
        EXPECT_EQ(with.bins[i].hull, without.bins[i].hull);
        EXPECT_LE(with.bins[i].distance.near, without.bins[i].distance.near);
      }
      for (size_t i = without.bins.size(); i < with.bins.size(); ++i) {
        const RayBin& bin = with.bins[i];
        EXPECT_FALSE(bin.hull.empty());
        EXPECT_EQ(bin.samples_begin, bin.samples_end);
        EXPECT_EQ(bin.pixels_begin, bin.pixels_end);
        EXPECT_EQ(bin.num_covered, 0);
        EXPECT_LE(bin.distance.near, bin.distance.far);
        EXPECT_LE(with.distance.near, with.distance.far);
        ++num_bins;
      }
    }
  }
  EXPECT_GT(num_bins, 100);
}

void ExpectSameMaps(const LightPlan& a, const LightPlan& b) {
  ASSERT_EQ(a.maps.size(), b.maps.size());
  for (size_t k = 0; k < a.maps.size(); ++k) {
    EXPECT_EQ(a.maps[k].map_from_world, b.maps[k].map_from_world);
  }
}

TEST(FinePlans, LeaveOutWhatIsNotKnownOrNotAskedFor) {
  Pictures pictures(21);
  pictures.fine.cover.lit_bits = {};
  const Surfaces surfaces = pictures.Found(), coarse_surfaces = pictures.Found(/*is_fine=*/false);
  const Light& light = pictures.lights[0];
  // Nothing is known of what a dark border answers wrongly.
  PlanOptions options = OptionsOf(Border::kDark);
  const auto dark = FitPlan(surfaces, light, options);
  const auto coarse_dark = FitPlan(coarse_surfaces, light, options);
  ASSERT_THAT(dark, IsOk());
  ASSERT_THAT(coarse_dark, IsOk());
  ExpectSameMaps(*dark, *coarse_dark);
  options = OptionsOf(Border::kLit);
  const auto fine = FitPlan(surfaces, light, options);
  const auto coarse_lit = FitPlan(coarse_surfaces, light, options);
  ASSERT_THAT(fine, IsOk());
  ASSERT_THAT(coarse_lit, IsOk());
  EXPECT_NE(fine->maps[0].map_from_world, coarse_lit->maps[0].map_from_world);
  options.fit.use_fine_cover = false;
  const auto not_asked = FitPlan(surfaces, light, options);
  ASSERT_THAT(not_asked, IsOk());
  ExpectSameMaps(*not_asked, *coarse_lit);
  // Everything in view has room.
  options = OptionsOf(Border::kLit);
  options.fit.cover = Cover::kReceivers;
  const auto all = FitPlan(surfaces, light, options);
  const auto coarse_all = FitPlan(coarse_surfaces, light, options);
  ASSERT_THAT(all, IsOk());
  ASSERT_THAT(coarse_all, IsOk());
  ExpectSameMaps(*all, *coarse_all);
}

// A wall with stripes of shadow before a lamp; in the finer image there is something dark at all
// distances, so in all directions from the lamp, and two maps cannot have it all in front.
TEST(FinePlans, LeaveOutWhatSurroundsALampWhereThereMayBeTooFewMapsForIt) {
  constexpr float kWall = 20.0f, kNearest = 1.0f;  // metres
  constexpr double kLamp = 5.0;
  const BoxScene scene = MakeBoxScene(1);
  SyntheticReadback coarse, image;
  coarse.camera = RandomCamera(scene, 1, 60, 40);
  coarse.depth.assign(60 * 40, kWall);
  for (int i = 0; i < 60 * 40; ++i) coarse.shadow_bits.push_back(i % 60 % 8 < 4 ? 1 : 0);
  coarse.facing_bits.assign(60 * 40, 1);
  image.camera = RandomCamera(scene, 1, 240, 160);
  testing::Random random(1);
  for (int i = 0; i < 240 * 160; ++i) {
    image.depth.push_back(static_cast<float>(random.Uniform(kNearest, kWall)));
  }
  image.shadow_bits.assign(240 * 160, 1);
  image.facing_bits.assign(240 * 160, 1);
  const AffineDepth affine_depth(coarse.camera, DepthKind::kCameraZ);
  const Eigen::Vector4d middle(30.0, 20.0, affine_depth.At(30, 20, kLamp), 1.0);
  const Light lamp = Light::Point(
      "lamp", (coarse.camera.WorldFromScreen() * middle).hnormalized(), /*shadow_bit=*/0);

  const FineImage fine(image);
  Readback readback = coarse.ViewWithFacing();
  const Surfaces coarse_surfaces = *FindSurfaces(readback, 0x1, {});
  readback.fine_cover = &fine.cover;
  const Surfaces surfaces = *FindSurfaces(readback, 0x1, {});
  for (const bool choose : {false, true}) {
    PlanOptions options = OptionsOf(Border::kLit, choose);
    options.max_maps = 2;
    const auto coarse_plan = FitPlan(coarse_surfaces, lamp, options);
    const auto plan = FitPlan(surfaces, lamp, options);
    ASSERT_THAT(coarse_plan, IsOk());
    ASSERT_THAT(plan, IsOk());
    EXPECT_GT(CountLost(surfaces, lamp, PlanOf(*plan)).outside, 1000);
    if (!choose) ExpectSameMaps(*plan, *coarse_plan);
    options.max_maps = kAlwaysEnoughMaps;
    const auto whole = FitPlan(surfaces, lamp, options);
    ASSERT_THAT(whole, IsOk());
    EXPECT_GE(whole->maps.size(), 4u);  // three never are enough all around
    const LostCells lost = CountLost(surfaces, lamp, PlanOf(*whole));
    EXPECT_EQ(lost.outside, 0);
    EXPECT_EQ(lost.out_of_depth, 0);
  }
}

// Trackers hold what is known of the read-back's pixels alone.
TEST(FinePlans, AreNotTracked) {
  const Pictures pictures(21);
  const Surfaces surfaces = pictures.Found(), coarse_surfaces = pictures.Found(/*is_fine=*/false);
  for (const double stability : {0.0, 0.5}) {
    PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
    options.plan = OptionsOf(Border::kLit);
    for (const Light& light : pictures.lights) {
      PlanTracker with(light, options), without(light, options);
      for (int frame = 0; frame < 2; ++frame) {
        const auto tracked = with.Update(surfaces);
        const auto coarse = without.Update(coarse_surfaces);
        ASSERT_THAT(tracked, IsOk());
        ASSERT_THAT(coarse, IsOk());
        ExpectSameMaps(tracked->plan, coarse->plan);
      }
    }
  }
}

}  // namespace
}  // namespace lightfit
