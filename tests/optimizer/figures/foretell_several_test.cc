#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "geometry/homography.h"
#include "geometry/ray_maps.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {128, 128};

// The left and the right part of a map, cut at a column of texels: two maps of the same texels.
std::vector<SizedMatrix> CutInTwo(const Eigen::Matrix4d& map_from_world, int column) {
  Eigen::Matrix4d right = map_from_world;
  right.row(0) -= column * right.row(3);
  return {{map_from_world, {column, kMap.height}}, {right, {kMap.width - column, kMap.height}}};
}

// What stands beyond the outermost pixel of each side is guessed map by map, and the cut is no side
// at which anything ends.
TEST(ForetellWrongShare, OfAMapCutInTwoIsThatOfTheMap) {
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 3);
    for (const bool with_facing : {false, true}) {
      const Readback readback =
          with_facing ? scene.readback.ViewWithFacing() : scene.readback.View();
      for (const Light& light : scene.lights) {
        const auto fit = FitLight(readback, light, kMap);
        ASSERT_THAT(fit, IsOk());
        const auto whole = ForetellWrongShare(readback, light, fit->map_from_world, kMap);
        ASSERT_THAT(whole, IsOk());
        for (const int column : {40, 64}) {
          const auto halves =
              ForetellWrongShare(readback, light, CutInTwo(fit->map_from_world, column));
          ASSERT_THAT(halves, IsOk());
          // Upper and lower side are two of each half, and each may end in a tip: 1.6 pixels.
          const double unseen = 4.0 * 1.6 / static_cast<double>(readback.depth.size());
          EXPECT_NEAR(*halves, *whole, with_facing ? unseen : 1e-9)
              << light.name << " seed " << seed;
          ++num_cases;
        }
      }
    }
  }
  EXPECT_GT(num_cases, 50);
}

// The denser of two maps is asked where it holds the pixel, so that a second, finer map of a part
// leaves less wrong; what only one holds is not outside.
TEST(ForetellWrongShare, ADenserMapOfAPartLeavesLessWrong) {
  int num_less = 0, num_cases = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 3);
    const Readback readback = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      const auto fit = FitLight(readback, light, kMap);
      ASSERT_THAT(fit, IsOk());
      // The middle of the map, four times as fine.
      Eigen::Matrix4d middle = fit->map_from_world;
      middle.topRows<2>() *= 4.0;
      middle.row(0) -= 1.5 * kMap.width * middle.row(3);
      middle.row(1) -= 1.5 * kMap.height * middle.row(3);
      const SizedMatrix whole = {fit->map_from_world, kMap};
      const auto one = ForetellWrongShare(readback, light, {whole});
      const auto both = ForetellWrongShare(readback, light, {whole, {middle, kMap}});
      ASSERT_THAT(both, IsOk());
      ++num_cases;
      num_less += *both < *one ? 1 : 0;
    }
  }
  EXPECT_GE(num_less, num_cases * 3 / 4);
}

TEST(ForetellWrongShare, SaysWhatIsWrongWithSeveralMaps) {
  const TestScene scene(1, 1);
  const Readback readback = scene.View();
  const Light& light = scene.lights[0];
  EXPECT_THAT(ForetellWrongShare(readback, light, absl::Span<const SizedMatrix>()),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("no map")));
  const auto fit = FitLight(readback, light, kMap);
  ASSERT_THAT(fit, IsOk());
  const SizedMatrix good = {fit->map_from_world, kMap};
  const SizedMatrix of_another = {Eigen::Matrix4d::Random(), kMap};
  EXPECT_THAT(ForetellWrongShare(readback, light, {good, of_another}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(light.name)));
}

TEST(RayMap, CoarsenessDoesNotDependOnTheScaleOfTheHomography) {
  const Eigen::Vector3d ray(0.2, -0.3, 1.0);
  Eigen::Matrix3d map_from_ray;
  map_from_ray << 100.0, 3.0, 50.0, -2.0, 80.0, 40.0, 0.1, -0.2, 1.0;
  const RayMap map(map_from_ray, 100, 80), scaled(7.0 * map_from_ray, 100, 80);
  EXPECT_NEAR(map.coarseness.dot(ray), scaled.coarseness.dot(ray), 1e-15);
  EXPECT_TRUE(map.Holds(ray));
  EXPECT_TRUE(scaled.Holds(ray));
  EXPECT_FALSE(map.Holds(ray, 40.0));
  EXPECT_FALSE(map.Holds(-ray));
}

}  // namespace
}  // namespace lightfit
