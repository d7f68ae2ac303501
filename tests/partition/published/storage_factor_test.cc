#include "partition/published/storage_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "methods/lispsm.h"
#include "tests/methods/random_input.h"
#include "tests/partition/published/lloyd_view.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::InputOf;
using testing::IsOk;
using testing::kBehind;
using testing::kOverhead;
using testing::Random;
using testing::StatusIs;
using testing::Texel;

// Central differences of a step of a millionth keep six digits of what strong warps spend little
// on.
constexpr double kDifferences = 1e-4;

// Errors at one point, by moving it across its ray of light.
BeamErrors ErrorsByDifferences(const MethodInput& input,
                               const MethodMap& map,
                               const Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = input.light.kind == Light::Kind::kPoint
                                  ? Eigen::Vector3d(point - input.light.position)
                                  : input.light.direction;
  const Eigen::Matrix3d frame = FrameAlong(ray);
  const double step = 1e-6 * CameraDepth(input.camera, point);
  Eigen::Matrix2d texel_from_step;
  for (const int i : {0, 1}) {
    const Eigen::Vector3d side = step * frame.row(i).transpose();
    texel_from_step.col(i) = (Texel(map, point + side) - Texel(map, point - side)) / (2.0 * step);
  }
  // A pixel of the image is one pixel of its width; the image is to have one in all.
  const Eigen::Vector2d pixels(input.camera.width, input.camera.height);
  const Eigen::Matrix2d step_from_pixel =
      CameraDepth(input.camera, point) *
      input.camera.screen_from_camera.topLeftCorner<2, 2>().inverse() * pixels.asDiagonal();
  const double pixel = std::sqrt(std::abs(step_from_pixel.determinant()));
  BeamErrors errors;
  errors.u = texel_from_step.inverse().col(0).norm() / pixel;
  // The distance between lines of equal v.
  errors.v = 1.0 / texel_from_step.row(1).norm() / pixel;
  return errors;
}

TEST(MaxBeamErrors, AgreeWithDifferences) {
  Random random(1);
  int num_maps = 0;
  for (int i = 0; i < 200; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const absl::StatusOr<MethodMap> map =
        SetUpMap(random.Coin() ? Method::kLispsm : Method::kFocused, input);
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (!map.ok() || body.empty()) continue;
    ++num_maps;
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d point = testing::PointIn(random, body);
      const auto errors =
          MaxBeamErrors(map->map_from_world, input.light, input.camera, {&point, 1});
      ASSERT_THAT(errors, IsOk());
      const BeamErrors expected = ErrorsByDifferences(input, *map, point);
      EXPECT_NEAR(errors->u / expected.u, 1.0, kDifferences) << i;
      EXPECT_NEAR(errors->v / expected.v, 1.0, kDifferences) << i;
    }
  }
  EXPECT_GT(num_maps, 80);
}

// Lloyd 2006, 4.4: no point within a body has larger errors than some of its corners.
TEST(MaxBeamErrors, AreLargestAtCorners) {
  Random random(2);
  int num_maps = 0;
  for (int i = 0; i < 200; ++i) {
    MethodInput input = testing::RandomInput(random);
    input.light = Light::Directional("sun", random.UnitVector());
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    const absl::StatusOr<MethodMap> map = SetUpMap(Method::kLispsm, input);
    if (!map.ok() || body.empty()) continue;
    ++num_maps;
    const auto at_corners = MaxBeamErrors(map->map_from_world, input.light, input.camera, body);
    ASSERT_THAT(at_corners, IsOk());
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d point = testing::PointIn(random, body);
      const auto errors =
          MaxBeamErrors(map->map_from_world, input.light, input.camera, {&point, 1});
      EXPECT_LE(errors->u, at_corners->u * (1.0 + 1e-9));
      EXPECT_LE(errors->v, at_corners->v * (1.0 + 1e-9));
    }
  }
  EXPECT_GT(num_maps, 80);
}

// (9), (10), (12) for a single map of any warp, and the unwarped one for a light behind.
TEST(StorageFactor, IsLloydsForOneMap) {
  const LloydView view = {1.0, 100.0, 0.5};
  MethodInput input = InputOf(view, kOverhead);
  for (const double eta : {-0.99, -0.5, -0.1, 0.0, 0.3, 1.0}) {
    LispsmOptions options;
    options.n = WarpOfEta(view, eta);
    const absl::StatusOr<MethodMap> map = LispsmMap(input, options);
    ASSERT_THAT(map, IsOk());
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    const auto errors = MaxBeamErrors(map->map_from_world, input.light, input.camera, body);
    ASSERT_THAT(errors, IsOk());
    const double width = input.map.width, height = input.map.height;
    EXPECT_NEAR(errors->u * width / MaxXError(view, *options.n), 1.0, 1e-9);
    EXPECT_NEAR(errors->v * height / MaxZError(view, *options.n), 1.0, 1e-9);
    Plan plan;
    plan.maps.push_back({map->map_from_world, input.map, {}});
    const absl::StatusOr<double> storage = StorageFactor(plan, input);
    ASSERT_THAT(storage, IsOk());
    EXPECT_NEAR(*storage / WarpStorage(view, *options.n), 1.0, 1e-9);
  }
  input = InputOf(view, kBehind);
  Plan plan;
  plan.maps.push_back({SetUpMap(Method::kFocused, input)->map_from_world, input.map, {}});
  EXPECT_NEAR(*StorageFactor(plan, input) / BehindStorage(view, 1.0), 1.0, 1e-9);
}

// Two half spaces that split the view: each map counts over its own half.
TEST(StorageFactor, CountsEachMapOverItsHalfSpaces) {
  const LloydView view = {1.0, 100.0, 0.5};
  const MethodInput input = InputOf(view, kOverhead);
  const Eigen::Matrix4d map_from_world = SetUpMap(Method::kLispsm, input)->map_from_world;
  const Eigen::RowVector4d beyond(0.0, 0.0, -1.0, -10.0);  // depth 10
  Plan plan;
  plan.maps.resize(2, {map_from_world, input.map, {}});
  plan.maps[0].half_spaces.push_back(-beyond);
  plan.maps[1].half_spaces.push_back(beyond);
  double expected = 0.0;
  for (const std::array<double, 2> range : {std::array{1.0, 10.0}, {10.0, 100.0}}) {
    double m_x = 0.0, m_z = 0.0;
    for (const double z : range) {
      m_x = std::max(m_x, XError(view, LispsmWarp(view), z));
      m_z = std::max(m_z, ZError(view, LispsmWarp(view), z));
    }
    expected += m_x * m_z;
  }
  EXPECT_NEAR(*StorageFactor(plan, input) / expected, 1.0, 1e-9);
  // Nothing is in view beyond the far plane.
  plan.maps[1].half_spaces.push_back(Eigen::RowVector4d(0.0, 0.0, -1.0, -101.0));
  EXPECT_LT(*StorageFactor(plan, input), expected);
}

TEST(StorageFactor, NamesAMapOfAnotherLight) {
  const MethodInput input = InputOf({1.0, 100.0, 0.5}, kOverhead);
  Plan plan;
  plan.maps.push_back({Eigen::Matrix4d::Zero(), input.map, {}});
  EXPECT_THAT(StorageFactor(plan, input),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sun")));
}

}  // namespace
}  // namespace lightfit
