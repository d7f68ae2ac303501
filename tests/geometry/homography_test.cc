#include "geometry/homography.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::MatrixNear;
using testing::Random;

// Receivers in a cube in front of a light, a map of their rays, and its depth row.
struct MapCase {
  Light light;
  std::vector<Eigen::Vector3d> receivers;
  Eigen::Matrix3d map_from_ray;
  Eigen::Matrix<double, 3, 4> ray_from_world;
  Eigen::Matrix4d map_from_world;
  double w_min;
};

MapCase RandomMapCase(Random& random, Light::Kind kind) {
  MapCase result;
  const double size = random.LogUniform(0.1, 100.0);
  for (int i = 0; i < 40; ++i) result.receivers.push_back(random.InCube(0.5 * size));
  const Eigen::Vector3d to_light = random.UnitVector();
  const double distance = size * random.LogUniform(2.0, 1e4);
  result.light = kind == Light::Kind::kPoint ? Light::Point("lamp", distance * to_light)
                                             : Light::Directional("sun", -3.0 * to_light);
  result.ray_from_world = RayFromWorld(result.light, -to_light);
  // X_3 is the distance along -to_light or 1; tilt the axis, keeping w > 0 on the cube.
  const double tilt = kind == Light::Kind::kPoint ? 0.5 * distance / size : 0.5 / size;
  result.map_from_ray << 10.0 * random.Rotation().topRows<2>(), random.Uniform(-tilt, tilt),
      random.Uniform(-tilt, tilt), 1.0;
  DepthRange range = {std::numeric_limits<double>::infinity(), -1e300};
  result.w_min = range.near;
  for (const Eigen::Vector3d& receiver : result.receivers) {
    const double w = result.map_from_ray.row(2).dot(result.ray_from_world * receiver.homogeneous());
    const double depth = kind == Light::Kind::kPoint ? w : receiver.dot(-to_light);
    range = {std::min(range.near, depth), std::max(range.far, depth)};
    result.w_min = std::min(result.w_min, w);
  }
  result.map_from_world =
      MapFromWorld(result.map_from_ray, result.ray_from_world, result.light, range, result.w_min);
  return result;
}

class MapFromWorldTest : public ::testing::TestWithParam<Light::Kind> {};

TEST_P(MapFromWorldTest, RowsOneTwoAndFourAreTheHomography) {
  Random random(41);
  for (int i = 0; i < 100; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    const Eigen::Matrix<double, 3, 4> rows = map.map_from_ray * map.ray_from_world;
    EXPECT_EQ(map.map_from_world.row(0), rows.row(0));
    EXPECT_EQ(map.map_from_world.row(1), rows.row(1));
    EXPECT_EQ(map.map_from_world.row(3), rows.row(2));
  }
}

TEST_P(MapFromWorldTest, ReceiversHaveDepthZeroToOne) {
  Random random(42);
  for (int i = 0; i < 200; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    ASSERT_GT(map.w_min, 0.0);
    double least = 2.0, most = -2.0;
    for (const Eigen::Vector3d& receiver : map.receivers) {
      const Eigen::Vector4d h = map.map_from_world * receiver.homogeneous();
      least = std::min(least, h.z() / h.w());
      most = std::max(most, h.z() / h.w());
    }
    EXPECT_GE(least, -1e-9);
    EXPECT_LE(most, 1.0 + 1e-9);
    EXPECT_LE(least, 0.5);  // the range is used, not just respected
    EXPECT_GT(most, 0.0);
    if (GetParam() == Light::Kind::kPoint) {
      EXPECT_NEAR(least, 0.0, 1e-9);
      EXPECT_NEAR(most, 1.0, 1e-9);
    }
  }
}

TEST_P(MapFromWorldTest, DepthGrowsAlongEveryRay) {
  Random random(43);
  for (int i = 0; i < 200; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    for (const Eigen::Vector3d& receiver : map.receivers) {
      const Eigen::Vector3d along = GetParam() == Light::Kind::kPoint
                                        ? Eigen::Vector3d(receiver - map.light.position)
                                        : map.light.direction;
      double before = -std::numeric_limits<double>::infinity();
      Eigen::Vector2d texel;
      for (const double step : {-0.2, -0.05, 0.0, 0.1, 0.5}) {
        const Eigen::Vector3d on_ray = receiver + step * along;
        const Eigen::Vector4d h = map.map_from_world * on_ray.homogeneous();
        ASSERT_GT(h.w(), 0.0);
        EXPECT_GT(h.z() / h.w(), before);
        before = h.z() / h.w();
      }
    }
  }
}

TEST_P(MapFromWorldTest, OneDepthIsWidened) {
  Random random(44);
  MapCase map = RandomMapCase(random, GetParam());
  const Eigen::Vector4d receiver = map.receivers[0].homogeneous();
  const double depth = GetParam() == Light::Kind::kPoint
                           ? map.map_from_ray.row(2).dot(map.ray_from_world * receiver)
                           : map.receivers[0].dot(map.light.direction.normalized());
  const Eigen::Matrix4d map_from_world =
      MapFromWorld(map.map_from_ray, map.ray_from_world, map.light, {depth, depth}, map.w_min);
  EXPECT_TRUE(map_from_world.allFinite());
  EXPECT_GT(map_from_world.row(2).norm(), 0.0);
  EXPECT_NEAR((map_from_world * receiver).hnormalized().z(), 0.0, 1e-6);
}

// MapFromRay() is in the frame of RayFromWorld(light), whatever frame the matrix was made in.
TEST_P(MapFromWorldTest, MapFromRayFindsTheHomographyAgain) {
  Random random(45);
  for (int i = 0; i < 200; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, map.light);
    ASSERT_THAT(map_from_ray, testing::IsOk());
    const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(map.light);
    for (const Eigen::Vector3d& receiver : map.receivers) {
      const Eigen::Vector4d expected = map.map_from_world * receiver.homogeneous();
      const Eigen::Vector3d place = *map_from_ray * (ray_from_world * receiver.homogeneous());
      // A lamp at 1e4 sizes cancels four digits; texels are of order 10.
      EXPECT_LE((place.hnormalized() - expected.head<2>() / expected.w()).norm(), 1e-8);
      EXPECT_LE(testing::RelativeError(place.z(), expected.w()), 1e-8);  // sign and size of w
    }
  }
}

TEST_P(MapFromWorldTest, MapFromRayAcceptsSinglePrecision) {
  Random random(46);
  for (int i = 0; i < 100; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    const Eigen::Matrix4d rounded = map.map_from_world.cast<float>().cast<double>();
    EXPECT_THAT(MapFromRay(rounded, map.light), testing::IsOk());
  }
}

TEST_P(MapFromWorldTest, MapFromRayRefusesAnotherLight) {
  Random random(47);
  for (int i = 0; i < 100; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    const Light::Kind other_kind =
        GetParam() == Light::Kind::kPoint ? Light::Kind::kDirectional : Light::Kind::kPoint;
    for (const Light::Kind kind : {GetParam(), other_kind}) {
      const Light other = RandomMapCase(random, kind).light;
      // A lamp is at least two sizes away and a thousandth off is another lamp.
      EXPECT_THAT(
          MapFromRay(map.map_from_world, other),
          testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr(other.name)));
    }
    EXPECT_THAT(MapFromRay(map.map_from_world.transpose(), map.light),
                testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::_));
  }
}

// In other units and about another origin it is the same map: X' = scale X + offset.
TEST_P(MapFromWorldTest, MapFromRayTakesMatricesOfAnyUnitsAndOrigin) {
  Random random(49);
  for (int i = 0; i < 300; ++i) {
    const MapCase map = RandomMapCase(random, GetParam());
    const double scale = random.LogUniform(1e-3, 1e4);
    const Eigen::Vector3d offset = scale * random.LogUniform(1e3, 1e8) * random.UnitVector();
    Light light = map.light;
    light.position = scale * map.light.position + offset;
    Eigen::Matrix4d moved_from_world = Eigen::Matrix4d::Identity();
    moved_from_world.topLeftCorner<3, 3>() *= scale;
    moved_from_world.topRightCorner<3, 1>() = offset;
    const Eigen::Matrix4d moved = map.map_from_world * moved_from_world.inverse();
    EXPECT_THAT(MapFromRay(moved, light), testing::IsOk());
    // And singular is singular there.
    Eigen::Matrix4d flat = moved;
    flat.row(1) = random.Uniform(-3.0, 3.0) * flat.row(0) + random.Uniform(-3.0, 3.0) * flat.row(3);
    EXPECT_THAT(
        MapFromRay(flat, light),
        testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr("singular")));
  }
}

// Receivers at one depth: z of what is behind them by a texel's side.
TEST(MapFromWorld, OneDepthIsWidenedAlikeInAnyUnitsAndOrigin) {
  const Light sun = Light::Directional("sun", -Eigen::Vector3d::UnitZ());
  for (const double scale : {1e-3, 1.0, 1e4}) {
    for (const double origin : {0.0, 1e3, 1e6}) {
      const Eigen::Vector3d middle = scale * Eigen::Vector3d(origin, -origin, origin);
      // Ten texels to the unit of the scene.
      Eigen::Matrix3d map_from_ray = Eigen::Vector3d(10.0 / scale, 10.0 / scale, 1.0).asDiagonal();
      const double depth = sun.direction.dot(middle);
      const Eigen::Matrix4d map_from_world =
          MapFromWorld(map_from_ray, RayFromWorld(sun), sun, {depth, depth}, 1.0);
      const Eigen::Vector3d behind = middle + 0.1 * scale * sun.direction;
      const double rounding = 1e-8;  // of a depth of 1e6, in tenths
      EXPECT_NEAR((map_from_world * middle.homogeneous()).z(), 0.0, rounding);
      EXPECT_NEAR((map_from_world * behind.homogeneous()).z(), 1.0, rounding);
    }
  }
}

TEST_P(MapFromWorldTest, MapFromRayRefusesWhatIsNotFiniteOrSingular) {
  Random random(48);
  const MapCase map = RandomMapCase(random, GetParam());
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Eigen::Matrix4d matrix = map.map_from_world;
    matrix(0, 1) = bad;
    EXPECT_THAT(
        MapFromRay(matrix, map.light),
        testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr("not finite")));
  }
  Eigen::Matrix4d flat = map.map_from_world;
  flat.row(1) = 2.0 * flat.row(0);
  EXPECT_THAT(
      MapFromRay(flat, map.light),
      testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr("singular")));
  EXPECT_THAT(MapFromRay(Eigen::Matrix4d::Zero(), map.light),
              testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::_));
  Light light = map.light;
  (light.kind == Light::Kind::kPoint ? light.position : light.direction).x() = std::nan("");
  EXPECT_THAT(MapFromRay(map.map_from_world, light),
              testing::StatusIs(absl::StatusCode::kInvalidArgument, ::testing::_));
}

INSTANTIATE_TEST_SUITE_P(Kinds,
                         MapFromWorldTest,
                         ::testing::Values(Light::Kind::kPoint, Light::Kind::kDirectional),
                         [](const auto& info) {
                           return info.param == Light::Kind::kPoint ? "Point" : "Directional";
                         });

}  // namespace
}  // namespace lightfit
