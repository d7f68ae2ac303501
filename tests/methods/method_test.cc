// What holds for every set-up, on random views, boxes and lights.
#include "methods/method.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>

#include "geometry/homography.h"
#include "methods/plane_optimal.h"
#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// Rounding of products of coordinates three box sizes from the origin, in shares of the map, where
// a warp of thousands to one may spend it on a sliver.
constexpr double kTexelTolerance = 1e-6;

class EveryMethod : public ::testing::TestWithParam<Method> {};

TEST_P(EveryMethod, CoversWhatIsInView) {
  Random random(1);
  int num_maps = 0, num_views = 0, num_own = 0;
  std::map<std::string, int> notes;
  for (int i = 0; i < 400; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
    if (!map.ok()) {
      // Only a lamp may be in the way, and only among what is to be covered.
      EXPECT_THAT(map, StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("\"lamp\"")));
      continue;
    }
    ++num_maps;
    if (!map->note.empty()) ++notes[map->note];
    num_own += map->note.empty() ? 1 : 0;
    ASSERT_TRUE(map->map_from_world.allFinite());
    const std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    num_views += body.empty() ? 0 : 1;
    for (size_t k = 0; k < (body.empty() ? 0 : body.size() + 50); ++k) {
      const Eigen::Vector3d point = k < body.size() ? body[k] : testing::PointIn(random, body);
      const Eigen::Vector4d h = map->map_from_world * point.homogeneous();
      ASSERT_GT(h.w(), 0.0) << i;
      const double u = h.x() / h.w() / input.map.width, v = h.y() / h.w() / input.map.height;
      ASSERT_GE(u, -kTexelTolerance) << i << map->note;
      ASSERT_LE(u, 1.0 + kTexelTolerance) << i << map->note;
      ASSERT_GE(v, -kTexelTolerance) << i << map->note;
      ASSERT_LE(v, 1.0 + kTexelTolerance) << i << map->note;
      ASSERT_GE(h.z() / h.w(), -kTexelTolerance) << i << map->note;
      ASSERT_LE(h.z() / h.w(), 1.0 + kTexelTolerance) << i << map->note;
    }
  }
  for (const auto& [note, count] : notes)
    std::printf("%d of %d: %s\n", count, num_maps, note.c_str());
  EXPECT_GT(num_maps, 250);
  EXPECT_GT(num_views, 150);
  EXPECT_GT(num_own, 50);
}

// The rows 1, 2 and 4 send the light to nothing, so a ray has one texel; and seen from the light
// the map is not mirrored.
TEST_P(EveryMethod, RaysGoToSingleTexels) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
    if (!map.ok()) continue;
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray =
        MapFromRay(map->map_from_world, input.light);
    ASSERT_THAT(map_from_ray, IsOk());
    EXPECT_GT(map_from_ray->determinant(), 0.0);
    std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (body.empty()) continue;
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d point = testing::PointIn(random, body);
      const Eigen::Vector4d h = map->map_from_world * point.homogeneous();
      // Towards the light, up to most of the way to a lamp.
      const double size = input.receivers.sizes().norm();
      const Eigen::Vector3d nearer =
          input.light.kind == Light::Kind::kPoint
              ? Eigen::Vector3d(point + random.Uniform(0.0, 0.8) * (input.light.position - point))
              : Eigen::Vector3d(point - random.Uniform(0.0, 2.0) * size *
                                            input.light.direction.normalized());
      const Eigen::Vector4d g = map->map_from_world * nearer.homogeneous();
      ASSERT_GT(g.w(), 0.0);
      const Eigen::Vector2d difference = g.head<2>() / g.w() - h.head<2>() / h.w();
      EXPECT_LE(std::abs(difference.x()), kTexelTolerance * input.map.width);
      EXPECT_LE(std::abs(difference.y()), kTexelTolerance * input.map.height);
      EXPECT_LE(g.z() / g.w(), h.z() / h.w() + kTexelTolerance);  // depth grows along the ray
    }
  }
}

// The map touches what it covers on all four sides.
TEST_P(EveryMethod, FitsTightly) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
    if (!map.ok()) continue;
    std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers);
    if (GetParam() == Method::kStandard || map->note.starts_with("standard")) {
      const std::array<Eigen::Vector3d, 8> corners = BoxCorners(input.receivers);
      body.assign(corners.begin(), corners.end());
    }
    Eigen::AlignedBox2d extent;
    for (const Eigen::Vector3d& corner : body) {
      extent.extend((map->map_from_world * corner.homogeneous()).hnormalized().head<2>());
    }
    const Eigen::Vector2d size(input.map.width, input.map.height);
    EXPECT_LE(extent.min().cwiseQuotient(size).cwiseAbs().maxCoeff(), kTexelTolerance);
    EXPECT_LE((extent.max() - size).cwiseQuotient(size).cwiseAbs().maxCoeff(), kTexelTolerance);
  }
}

// Cuts leave a part of what is in view: the map lies tightly around that.
TEST_P(EveryMethod, FitsTightlyAroundAPartOfTheView) {
  Random random(8);
  int num_maps = 0;
  for (int i = 0; i < 200; ++i) {
    MethodInput input = testing::RandomInput(random);
    const std::vector<Eigen::Vector3d> whole = ViewBody(input.camera, input.receivers);
    if (whole.empty()) continue;
    const Eigen::Vector3d normal = random.UnitVector();
    input.cuts.emplace_back(
        normal.x(), normal.y(), normal.z(), -normal.dot(testing::PointIn(random, whole)));
    const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
    if (!map.ok() || map->note.starts_with("standard")) continue;
    ++num_maps;
    std::vector<Eigen::Vector3d> body = ViewBody(input.camera, input.receivers, input.cuts);
    if (GetParam() == Method::kStandard) {  // the whole box all the same
      const std::array<Eigen::Vector3d, 8> corners = BoxCorners(input.receivers);
      body.assign(corners.begin(), corners.end());
    }
    Eigen::AlignedBox2d extent;
    for (const Eigen::Vector3d& corner : body) {
      const Eigen::Vector4d h = map->map_from_world * corner.homogeneous();
      ASSERT_GT(h.w(), 0.0);
      extent.extend(h.hnormalized().head<2>());
    }
    const Eigen::Vector2d size(input.map.width, input.map.height);
    EXPECT_LE(extent.min().cwiseQuotient(size).cwiseAbs().maxCoeff(), kTexelTolerance);
    EXPECT_LE((extent.max() - size).cwiseQuotient(size).cwiseAbs().maxCoeff(), kTexelTolerance);
  }
  EXPECT_GT(num_maps, 50);
}

TEST_P(EveryMethod, RepeatsTheSameBits) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const MethodInput input = testing::RandomInput(random);
    const absl::StatusOr<MethodMap> a = SetUpMap(GetParam(), input);
    const absl::StatusOr<MethodMap> b = SetUpMap(GetParam(), input);
    ASSERT_EQ(a.ok(), b.ok());
    if (a.ok()) {
      EXPECT_EQ(a->map_from_world, b->map_from_world);
    }
  }
}

// Where all goes wrong at once: flat boxes, edge-on and aligned lights, lights at the eye, points.
TEST_P(EveryMethod, DegenerateInputGivesFiniteMapsOrReasons) {
  Random random(5);
  int num_maps = 0;
  for (int i = 0; i < 400; ++i) {
    MethodInput input = testing::RandomInput(random);
    const Eigen::Vector3d eye = EyePosition(input.camera);
    const Eigen::Vector3d view = ViewDirection(input.camera);
    const int flat_axis = random.Int(0, 5);
    if (flat_axis < 3) input.receivers.min()(flat_axis) = input.receivers.max()(flat_axis);
    if (flat_axis == 4) input.receivers.min() = input.receivers.max();
    switch (random.Int(0, 8)) {
      case 0:
        input.light = Light::Directional("sun", view);
        break;
      case 1:
        input.light = Light::Directional("sun", -view);
        break;
      case 2:
        input.light = Light::Point("lamp", eye);
        break;
      case 3:
        input.light = Light::Point("lamp", eye - random.Uniform(0.0, 1.0) * view);
        break;
      case 4:
        input.light = Light::Point("lamp", input.receivers.center());
        break;
      case 5:
        input.light = Light::Point("lamp", input.receivers.max());
        break;
      case 6:
        input.light = Light::Directional("sun", Eigen::Vector3d::Unit(random.Int(0, 2)));
        break;
      case 7:
        input.camera.orthographic = true;
        input.camera.screen_from_camera(0, 0) = 20.0 / input.camera.near;
        input.camera.screen_from_camera(1, 1) = 20.0 / input.camera.near;
        break;
      default:
        input.light = Light::Point("lamp", eye + view * input.camera.far);
    }
    const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
    if (!map.ok()) {
      EXPECT_EQ(map.status().code(), absl::StatusCode::kFailedPrecondition) << map.status();
      continue;
    }
    ++num_maps;
    EXPECT_TRUE(map->map_from_world.allFinite());
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      EXPECT_GT(map->map_from_world.row(3).dot(point.homogeneous()), 0.0) << i << map->note;
    }
  }
  EXPECT_GT(num_maps, 100);
}

TEST_P(EveryMethod, NamesAWrongInput) {
  Random random(6);
  const MethodInput good = testing::RandomInput(random);
  const auto expect_error = [](const MethodInput& input, const std::string& field) {
    EXPECT_THAT(
        SetUpMap(GetParam(), input),
        StatusIs(absl::StatusCode::kInvalidArgument, AllOf(HasSubstr(field), HasSubstr("want"))));
  };
  MethodInput input = good;
  input.light = Light::Directional("sun", Eigen::Vector3d::Zero());
  expect_error(input, "direction = (0, 0, 0)");
  input = good;
  input.camera.near = 0.0;
  expect_error(input, "near = 0");
  input = good;
  input.camera.far = std::numeric_limits<double>::infinity();
  expect_error(input, "far = inf");
  input = good;
  input.camera.width = 0;
  expect_error(input, "size = 0x");
  input = good;
  input.receivers.setEmpty();
  expect_error(input, "receivers");
  input = good;
  input.receivers.max().x() = std::nan("");
  expect_error(input, "receivers");
  input = good;
  input.map.height = 0;
  expect_error(input, "map = ");
  input = good;
  input.plane.emplace(Eigen::Vector3d::Zero(), 1.0);
  expect_error(input, "plane");
  input = good;
  input.cuts.emplace_back(0.0, std::nan(""), 1.0, 0.0);
  expect_error(input, "cuts");
}

TEST_P(EveryMethod, FallsBackToStandardWithNothingInView) {
  MethodInput input;
  input.light = Light::Directional("sun", Eigen::Vector3d(0.2, -1.0, 0.1));
  input.camera = *LookAtCamera(
      Eigen::Vector3d(0, 2, 0), Eigen::Vector3d(0, 10, 0.1), Eigen::Vector3d::UnitX(), 1.0, 64, 64);
  input.camera.near = 0.1;
  input.camera.far = 100.0;
  input.receivers = {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1)};
  input.map = {256, 256};
  const absl::StatusOr<MethodMap> map = SetUpMap(GetParam(), input);
  ASSERT_THAT(map, IsOk());
  EXPECT_EQ(map->map_from_world, SetUpMap(Method::kStandard, input)->map_from_world);
  EXPECT_EQ(map->note.starts_with("standard: "), GetParam() != Method::kStandard);
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         EveryMethod,
                         ::testing::ValuesIn(AllMethods()),
                         [](const auto& info) {
                           std::string name = MethodName(info.param);
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(ParseMethod, KnowsEveryName) {
  for (const Method method : AllMethods()) {
    const absl::StatusOr<Method> parsed = ParseMethod(MethodName(method));
    ASSERT_THAT(parsed, IsOk());
    EXPECT_EQ(*parsed, method);
  }
  EXPECT_THAT(ParseMethod("lispm"),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("\"lispm\""), HasSubstr("standard, focused, tsm"))));
}

}  // namespace
}  // namespace lightfit
