#include "methods/lispsm.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "methods/focused.h"
#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::LevelView;
using testing::Random;
using testing::StatusIs;
using testing::Texel;

// A sun above the level view, its direction `angle` away from the view's.
Eigen::Vector3d SunAt(double angle) { return {0.0, -std::sin(angle), -std::cos(angle)}; }

// Texels along v per unit of b, the view's direction as the sun sees it, at a point in view.
double Density(const MethodMap& map, const Eigen::Vector3d& point, const Eigen::Vector3d& along) {
  constexpr double kStep = 1e-5;
  return std::abs(Texel(map, point + kStep * along).y() - Texel(map, point - kStep * along).y()) /
         (2.0 * kStep);
}

// The body's corner of least b, the nearest to the camera of several.
Eigen::Vector3d StartOf(const std::vector<Eigen::Vector3d>& body,
                        const Camera& camera,
                        const Eigen::Vector3d& along) {
  constexpr double kRounding = 1e-9;
  Eigen::Vector3d start = body[0];
  for (const Eigen::Vector3d& point : body) {
    const double further = along.dot(point - start);
    const bool nearer = CameraDepth(camera, point) < CameraDepth(camera, start);
    if (further < -kRounding || (further < kRounding && nearer)) start = point;
  }
  return start;
}

// What the general n is made for: along a line in the image plane that begins where the body does,
// texels per pixel are the same at the two ends of the map. For lights within the cone of the view,
// 0.5 from its axis, the body begins at its far plane.
TEST(LispsmMap, GeneralFormulaBalancesTheTwoEnds) {
  for (const double angle : {M_PI / 2, 1.2, 0.8, 0.4, 0.2, M_PI - 0.3}) {
    const MethodInput input = LevelView(SunAt(angle));
    const absl::StatusOr<MethodMap> map = LispsmMap(input);
    ASSERT_THAT(map, IsOk());
    const Eigen::Vector3d sun = SunAt(angle), view(0.0, 0.0, -1.0);
    const Eigen::Vector3d along = (view - view.dot(sun) * sun).normalized();
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    const Eigen::Vector3d start = StartOf(body, input.camera, along);
    double length = 0.0;
    for (const Eigen::Vector3d& point : body) length = std::max(length, along.dot(point - start));
    const double z0 = CameraDepth(input.camera, start);
    const bool within_cone = std::abs(std::sin(angle)) < std::sin(0.5);
    EXPECT_NEAR(z0, within_cone ? input.camera.far : input.camera.near, 1e-9) << angle;
    const Eigen::Vector3d end = start + length * along;
    const double z1 = CameraDepth(input.camera, end);
    const double at_start = Density(*map, start, along), at_end = Density(*map, end, along);
    EXPECT_NEAR(at_start * z0 / (at_end * z1), 1.0, 1e-6) << angle;
    if (angle == M_PI / 2) {
      // The published special case: n' = n + sqrt(n f), so densities are as (n' + d)^2 to n'^2.
      const double n = 1.0 + std::sqrt(20.0);
      EXPECT_NEAR(at_start / at_end, (n + 19.0) * (n + 19.0) / (n * n), 1e-4);
    }
  }
}

// Lloyd 2006, 4.4: the product of the largest ratios of a texel's width to a pixel's, across and
// along the warp. They are largest at corners of the view.
double StorageFactor(const MethodInput& input, const MethodMap& map) {
  const Eigen::Vector3d sun = input.light.direction.normalized(), view(0.0, 0.0, -1.0);
  const Eigen::Vector3d along = (view - view.dot(sun) * sun).normalized();
  const Eigen::Vector3d across = along.cross(sun);
  const double tan_theta = std::tan(0.5);
  double m_x = 0.0, m_z = 0.0;
  for (const Eigen::Vector3d& corner : FrustumCorners(input.camera)) {
    const double z = CameraDepth(input.camera, corner);
    const double step = 1e-6 * z;
    const double ds = (Texel(map, corner + step * across) - Texel(map, corner - step * across)).x();
    const double dt = (Texel(map, corner + step * along) - Texel(map, corner - step * along)).y();
    m_x = std::max(m_x, input.map.width * 2.0 * step / (std::abs(ds) * 2.0 * z * tan_theta));
    m_z = std::max(m_z, input.map.height * 2.0 * step / (std::abs(dt) * 2.0 * z * tan_theta));
  }
  return m_x * m_z;
}

// From straight behind no warp is possible, and (far / near)^2 texels a pixel are needed. The
// square of the far plane, turned by half a right angle, fills half of a square around it; more
// than twice that no light should need by much, wherever it is.
TEST(LispsmMap, NoLightNeedsManyMoreTexelsThanOneStraightBehind) {
  constexpr double kTwiceAndSome = 2.3;  // largest measured: 1.99; with the nearest depth 11.2
  MethodInput input = LevelView({0.0, 0.0, -1.0});
  input.camera.far = 1000.0;
  input.receivers = {Eigen::Vector3d::Constant(-2000.0), Eigen::Vector3d::Constant(2000.0)};
  Random random(24);
  double largest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    // Half of them within the cone of the view.
    Eigen::Vector3d sun = random.UnitVector();
    if (random.Coin()) {
      sun = {random.Uniform(-0.6, 0.6), random.Uniform(-0.6, 0.6), random.Coin() ? 1.0 : -1.0};
    }
    input.light = Light::Directional("sun", sun);
    const absl::StatusOr<MethodMap> map = LispsmMap(input);
    ASSERT_THAT(map, IsOk());
    largest = std::max(largest, StorageFactor(input, *map) / 1e6);
  }
  EXPECT_LT(largest, kTwiceAndSome);
  EXPECT_GT(largest, 1.5);
  std::printf("%g times the texels of a light straight behind\n", largest);
}

TEST(LispsmMap, SimpleFormulaIsNearPlusRootOverSine) {
  for (const double angle : {M_PI / 2, 1.0, 0.3}) {
    const MethodInput input = LevelView(SunAt(angle));
    LispsmOptions simple, given;
    simple.formula = LispsmOptions::Formula::kSimple;
    given.n = (1.0 + std::sqrt(1.0 * 20.0)) / std::sin(angle);
    const absl::StatusOr<MethodMap> a = LispsmMap(input, simple), b = LispsmMap(input, given);
    ASSERT_THAT(a, IsOk());
    ASSERT_THAT(b, IsOk());
    EXPECT_LE(testing::HomogeneousError(a->map_from_world, b->map_from_world), 1e-12);
  }
}

// The map tends to the focused one, in proportion to the angle.
TEST(LispsmMap, TurnsIntoTheFocusedMapAsLightAndViewAlign) {
  double before = 0.0;
  for (const double angle : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const MethodInput input = LevelView(SunAt(angle));
    const absl::StatusOr<MethodMap> warped = LispsmMap(input);
    const absl::StatusOr<MethodMap> focused = FocusedMap(input, {.min_area_rotation = false});
    ASSERT_THAT(warped, IsOk());
    ASSERT_THAT(focused, IsOk());
    EXPECT_EQ(warped->note, "");
    double largest = 0.0;
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      largest = std::max(largest, (Texel(*warped, point) - Texel(*focused, point)).norm());
    }
    if (before > 0.0) {
      EXPECT_NEAR(largest / before, 0.1, 0.05) << angle;
    }
    before = largest;
  }
  EXPECT_LT(before, 1e-2);  // texels of 512
  for (const double sign : {1.0, -1.0}) {
    const absl::StatusOr<MethodMap> aligned = LispsmMap(LevelView(sign * SunAt(0.0)));
    ASSERT_THAT(aligned, IsOk());
    EXPECT_EQ(aligned->note, "focused: the light is along the view");
  }
}

// A lamp far away is a sun: n, which is derived apart for it, must agree.
TEST(LispsmMap, FarLampsAreSuns) {
  Random random(21);
  for (int i = 0; i < 100; ++i) {
    MethodInput input = testing::RandomInput(random);
    const Eigen::Vector3d travel = random.UnitVector();
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (body.empty()) continue;
    LispsmOptions options;
    if (random.Coin()) options.formula = LispsmOptions::Formula::kSimple;
    input.light = Light::Directional("sun", travel);
    const absl::StatusOr<MethodMap> sun = LispsmMap(input, options);
    const double distance = 1e7 * input.receivers.sizes().norm();
    input.light = Light::Point("lamp", input.receivers.center() - distance * travel);
    const absl::StatusOr<MethodMap> lamp = LispsmMap(input, options);
    ASSERT_THAT(sun, IsOk());
    ASSERT_THAT(lamp, IsOk());
    const Eigen::Vector2d size(input.map.width, input.map.height);
    for (const Eigen::Vector3d& point : body) {
      const Eigen::Vector2d difference = Texel(*sun, point) - Texel(*lamp, point);
      // The image planes may be turned half round against each other.
      const Eigen::Vector2d turned = size - Texel(*sun, point) - Texel(*lamp, point);
      EXPECT_LE(std::min(difference.cwiseQuotient(size).norm(), turned.cwiseQuotient(size).norm()),
                1e-4);
    }
  }
}

TEST(LispsmMap, NarrowNWarpsMore) {
  const MethodInput input = LevelView(SunAt(1.2));
  double before = 0.0;
  for (const double scale : {0.1, 0.3, 1.0, 3.0, 1e6}) {
    LispsmOptions options;
    options.n_scale = scale;
    const absl::StatusOr<MethodMap> map = LispsmMap(input, options);
    ASSERT_THAT(map, IsOk());
    double least = 1e300, greatest = 0.0;
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      const double w = map->map_from_world.row(3).dot(point.homogeneous());
      least = std::min(least, w);
      greatest = std::max(greatest, w);
    }
    EXPECT_GT(least / greatest, before);
    before = least / greatest;
  }
  EXPECT_NEAR(before, 1.0, 1e-4);
}

TEST(LispsmMap, FallsBackForOrthographicViews) {
  MethodInput input = LevelView(SunAt(1.0));
  input.camera.orthographic = true;
  input.camera.screen_from_camera.topLeftCorner<2, 2>() *= 0.1;
  const absl::StatusOr<MethodMap> map = LispsmMap(input);
  ASSERT_THAT(map, IsOk());
  EXPECT_EQ(map->note, "focused: the view is orthographic");
}

TEST(LispsmMap, NamesAWrongOption) {
  const MethodInput input = LevelView(SunAt(1.0));
  LispsmOptions options;
  options.n_scale = 0.0;
  EXPECT_THAT(LispsmMap(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("n_scale = 0")));
  options = {};
  options.n = std::nan("");
  EXPECT_THAT(LispsmMap(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("n = nan")));
  options = {};
  options.centre = Eigen::Vector3d(0.0, std::nan(""), 0.0);
  EXPECT_THAT(LispsmMap(input, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("centre")));
}

}  // namespace
}  // namespace lightfit
