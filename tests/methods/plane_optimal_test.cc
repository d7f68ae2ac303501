#include "methods/plane_optimal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::Texel;
using Plane = Eigen::Hyperplane<double, 3>;
using Cover = PlaneOptimalOptions::Cover;

// Looks down on a floor that fills the screen, a box of the given height on it.
MethodInput FloorView(double height, const Light& light) {
  MethodInput input;
  input.light = light;
  input.camera = *LookAtCamera(
      Eigen::Vector3d(0, 6, 8), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d::UnitY(), 0.7, 320, 200);
  input.camera.near = 0.5;
  input.camera.far = 100.0;
  input.receivers = {Eigen::Vector3d(-50, 0, -50), Eigen::Vector3d(50, height, 50)};
  input.plane = Plane(Eigen::Vector3d::UnitY(), 0.0);
  input.map = {320, 200};
  return input;
}

Eigen::Vector3d OnFloor(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector4d ray =
      camera.WorldFromScreen() * Eigen::Vector4d(pixel.x(), pixel.y(), 1, 1);
  const Eigen::Vector3d eye = EyePosition(camera);
  const Eigen::Vector3d direction = ray.hnormalized() - eye;
  return eye - eye.y() / direction.y() * direction;
}

// The paper's title: with a map of the screen's size, a texel for every pixel of the plane.
TEST(PlaneOptimalMap, ScreenCoverIsTheScreenOnThePlane) {
  Random random(51);
  const std::vector<Light> lights = {Light::Directional("sun", Eigen::Vector3d(0.5, -1.0, -0.3)),
                                     Light::Directional("low", Eigen::Vector3d(0.5, -0.1, 0.7)),
                                     Light::Point("lamp", Eigen::Vector3d(-2.0, 5.0, 1.0))};
  for (const Light& light : lights) {
    const MethodInput input = FloorView(0.0, light);
    const absl::StatusOr<MethodMap> map = PlaneOptimalMap(input, {Cover::kScreen});
    ASSERT_THAT(map, IsOk());
    EXPECT_EQ(map->note, "");
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector2d pixel(random.Uniform(0.0, 320.0), random.Uniform(0.0, 200.0));
      EXPECT_LE((Texel(*map, OnFloor(input.camera, pixel)) - pixel).norm(), 1e-9) << light.name;
    }
  }
}

// Whatever the rectangle, texels per pixel on the plane are the same everywhere: u depends on x
// alone and v on y, both linearly.
TEST(PlaneOptimalMap, TexelsPerPixelAreConstantOnThePlane) {
  Random random(52);
  int num_maps = 0;
  for (int i = 0; i < 200; ++i) {
    Light light = Light::Directional("sun", random.UnitVector());
    if (random.Coin()) light = Light::Point("lamp", 30.0 * random.UnitVector());
    const MethodInput input = FloorView(random.Uniform(0.0, 2.0), light);
    const absl::StatusOr<MethodMap> map = PlaneOptimalMap(input);
    if (!map.ok() || !map->note.empty()) continue;
    ++num_maps;
    const auto texel = [&](double x, double y) {
      return Texel(*map, OnFloor(input.camera, {x, y}));
    };
    const Eigen::Vector2d first = texel(0, 0);
    const Eigen::Vector2d per_x = (texel(320, 0) - first) / 320;
    const Eigen::Vector2d per_y = (texel(0, 200) - first) / 200;
    EXPECT_NEAR(per_x.y(), 0.0, 1e-9);
    EXPECT_NEAR(per_y.x(), 0.0, 1e-9);
    for (int k = 0; k < 20; ++k) {
      const double x = random.Uniform(0.0, 320.0), y = random.Uniform(0.0, 200.0);
      EXPECT_LE((texel(x, y) - first - x * per_x - y * per_y).norm(), 1e-7);
    }
  }
  EXPECT_GT(num_maps, 50);
}

TEST(PlaneOptimalMap, ScreenCoverSaysWhenReceiversAreLeftOut) {
  const MethodInput input =
      FloorView(3.0, Light::Directional("sun", Eigen::Vector3d(0.2, -1.0, 0.8)));
  const absl::StatusOr<MethodMap> map = PlaneOptimalMap(input, {Cover::kScreen});
  ASSERT_THAT(map, IsOk());
  EXPECT_THAT(map->note, HasSubstr("receivers off the plane reach out of the map"));
}

TEST(PlaneOptimalMap, ReceiverCoverFallsBackWhereRaysLandBehindTheCamera) {
  // A low sun from the front: what stands near the camera casts its shadow point behind it.
  const MethodInput input =
      FloorView(5.0, Light::Directional("sun", Eigen::Vector3d(0.2, -0.1, 1.0)));
  const absl::StatusOr<MethodMap> map = PlaneOptimalMap(input);
  ASSERT_THAT(map, IsOk());
  EXPECT_THAT(map->note, HasSubstr("focused: rays of receivers off the plane"));
}

TEST(PlaneOptimalMap, FallsBackWhereThePlaneIsEdgeOn) {
  MethodInput input = FloorView(1.0, Light::Directional("sun", Eigen::Vector3d(1.0, 0.0, 0.3)));
  EXPECT_EQ(PlaneOptimalMap(input)->note, "focused: the light is in the plane");
  input.light = Light::Directional("sun", Eigen::Vector3d(0.1, -1.0, 0.3));
  input.plane = Plane(Eigen::Vector3d::UnitX(), 0.0);  // the eye is in it
  EXPECT_EQ(PlaneOptimalMap(input)->note, "focused: the plane is seen edge-on");
}

TEST(PlaneOptimalMap, WorksForOrthographicViews) {
  MethodInput input = FloorView(1.0, Light::Directional("sun", Eigen::Vector3d(0.2, -1.0, 0.3)));
  input.camera.orthographic = true;
  input.camera.screen_from_camera.topLeftCorner<2, 2>() = 20.0 * Eigen::Matrix2d::Identity();
  const absl::StatusOr<MethodMap> map = PlaneOptimalMap(input);
  ASSERT_THAT(map, IsOk());
  EXPECT_EQ(map->note, "");
  EXPECT_LE(map->map_from_world.row(3).head<3>().norm(), 1e-12);
}

TEST(MostVisibleFace, IsTheLitFaceThatFillsMostOfTheScreen) {
  MethodInput input = FloorView(20.0, Light::Directional("sun", Eigen::Vector3d(0.2, -1.0, 0.3)));
  const std::optional<Plane> floor = MostVisibleFace(input);
  ASSERT_TRUE(floor.has_value());
  EXPECT_LE((floor->coeffs() - Eigen::Vector4d(0, 1, 0, 0)).norm(), 1e-12);
  input.plane.reset();
  const MethodInput given = FloorView(20.0, input.light);
  EXPECT_EQ(PlaneOptimalMap(input, {Cover::kScreen})->map_from_world,
            PlaneOptimalMap(given, {Cover::kScreen})->map_from_world);

  // Lit from below the floor's inner side is dark: the far wall is next.
  input.light = Light::Directional("sun", Eigen::Vector3d(0.2, 1.0, -0.3));
  const std::optional<Plane> wall = MostVisibleFace(input);
  if (wall.has_value()) {
    EXPECT_LT(std::abs(wall->normal().y()), 0.5);
  }
  // A box without thickness is a floor still.
  input = FloorView(0.0, Light::Directional("sun", Eigen::Vector3d(0.2, -1.0, 0.3)));
  ASSERT_TRUE(MostVisibleFace(input).has_value());
  EXPECT_EQ(MostVisibleFace(input)->normal(), Eigen::Vector3d::UnitY());
}

}  // namespace
}  // namespace lightfit
