#include "partition/sphere_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdint>

#include "absl/strings/str_format.h"
#include "partition/fit_plan.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::StatusIs;

// Above the floor, in front of a camera: receivers are on many sides of it.
struct HangingLamp {
  Light light;
  SyntheticReadback readback;

  explicit HangingLamp(uint64_t seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const Camera camera = RandomCamera(scene, seed, 64, 48);
    const Eigen::Matrix4d world_from_camera = camera.camera_from_world.inverse();
    testing::Random random(seed);
    Eigen::Vector3d position =
        (world_from_camera * Eigen::Vector4d(0.0, 0.0, random.Uniform(5.0, 15.0), 1.0)).head<3>();
    position.z() = random.Uniform(0.5, 4.0);
    light = Light::Point("lamp", position);
    readback = Render(scene, camera, {&light, 1});
  }
};

// Without forecasts, which rank plans and decide nothing about whether there are any.
PlanOptions OptionsOf(int max_maps, const FitOptions& fit) {
  PlanOptions options;
  options.fit = fit;
  options.max_maps = max_maps;
  options.texels = 200 * 200;
  options.choose_by_forecast = false;
  return options;
}

TEST(SphereCells, NumMapsAroundIsTheFewestThatHaveAPlan) {
  int num_surrounded = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const HangingLamp lamp(seed);
    const Readback readback = lamp.readback.ViewWithFacing();
    FitOptions fit;
    fit.cover = Cover::kReceivers;
    const absl::StatusOr<Surfaces> surfaces = FindSurfaces(readback, 1, fit.samples);
    ASSERT_THAT(surfaces, IsOk());
    const absl::StatusOr<LightView> view = ViewLight(*surfaces, lamp.light, fit);
    ASSERT_THAT(view, IsOk());
    const absl::StatusOr<int> num_maps = NumMapsAround(*view, fit);
    ASSERT_THAT(num_maps, IsOk());
    EXPECT_EQ(*num_maps > 0, !view->cover.ok());
    if (*num_maps == 0) continue;
    ++num_surrounded;
    EXPECT_GE(*num_maps, 2);
    EXPECT_LE(*num_maps, kAlwaysEnoughMaps);
    EXPECT_THAT(FitPlan(*surfaces, lamp.light, OptionsOf(*num_maps, fit)), IsOk());
    if (*num_maps == 2) continue;
    EXPECT_THAT(FitPlan(*surfaces, lamp.light, OptionsOf(*num_maps - 1, fit)),
                StatusIs(absl::StatusCode::kFailedPrecondition,
                         ::testing::HasSubstr(absl::StrFormat("; %d would do", *num_maps))));
  }
  EXPECT_GE(num_surrounded, 3);
}

// Another reason to have no map, of which several are no way out.
TEST(SphereCells, NoMapsAreAroundALightInAPlaneWithItsReceivers) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const Light light = Light::Point("in the floor", {20.0, 20.0, 0.0});
  const FitOptions fit;
  const Readback readback = floor.View();
  const absl::StatusOr<Surfaces> surfaces = FindSurfaces(readback, 1, fit.samples);
  ASSERT_THAT(surfaces, IsOk());
  const absl::StatusOr<LightView> view = ViewLight(*surfaces, light, fit);
  ASSERT_THAT(view, IsOk());
  ASSERT_FALSE(view->cover.ok());
  const absl::StatusOr<int> num_maps = NumMapsAround(*view, fit);
  ASSERT_THAT(num_maps, IsOk());
  EXPECT_EQ(*num_maps, 0);
}

}  // namespace
}  // namespace lightfit
