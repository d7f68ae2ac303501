#include "partition/published/separating_plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "geometry/homography.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

Light RandomLight(Random& random, bool is_lamp) {
  if (!is_lamp) return Light::Directional("sun", random.UnitVector());
  return Light::Point("lamp", random.InCube(3.0));
}

// A map of the light with a warp, of a random scale of texels and of its homogeneous rows.
Eigen::Matrix4d RandomMap(const Light& light, Random& random) {
  Eigen::Matrix3d map_from_ray = random.Rotation();
  if (light.kind == Light::Kind::kDirectional) {
    map_from_ray.topRightCorner<2, 1>().setZero();
    map_from_ray.row(2) << random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), 1.0;
  }
  map_from_ray.topRows<2>() *= random.LogUniform(30.0, 300.0);
  map_from_ray *= random.LogUniform(0.01, 100.0);
  return MapFromWorld(map_from_ray, RayFromWorld(light), light, DepthRange{1.0, 10.0}, 0.1);
}

double WOf(const Eigen::Matrix4d& map, const Eigen::Vector3d& world) {
  return map.row(3).dot(world.homogeneous());
}

// Texels per area of a plane through the point, by central differences.
double DensityByDifferences(const Eigen::Matrix4d& map,
                            const Eigen::Vector3d& world,
                            const Eigen::Vector3d& side,
                            const Eigen::Vector3d& other_side) {
  constexpr double kStep = 1e-5;
  const auto texel = [&](const Eigen::Vector3d& at) -> Eigen::Vector2d {
    const Eigen::Vector4d h = map * at.homogeneous();
    return h.head<2>() / h.w();
  };
  Eigen::Matrix2d jacobian;
  jacobian.col(0) = texel(world + kStep * side) - texel(world - kStep * side);
  jacobian.col(1) = texel(world + kStep * other_side) - texel(world - kStep * other_side);
  return std::abs(jacobian.determinant()) / (4.0 * kStep * kStep);
}

TEST(SeparatingPlane, IsWhereDensitiesAreEqualAndTheFirstIsDenserBeyond) {
  constexpr double kDifferences = 1e-4;  // relative, of central differences twice
  for (const bool is_lamp : {false, true}) {
    int num_on_plane = 0, num_off = 0;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
      Random random(seed);
      const Light light = RandomLight(random, is_lamp);
      const Eigen::Matrix4d first = RandomMap(light, random), second = RandomMap(light, random);
      const auto plane = SeparatingPlane(first, second, light);
      ASSERT_THAT(plane, IsOk());
      const Eigen::RowVector3d normal = plane->head<3>();
      for (int i = 0; i < 60; ++i) {
        Eigen::Vector3d world = random.InCube(4.0);
        const bool on_plane = random.Coin();
        if (on_plane) {
          world -= plane->dot(world.homogeneous()) / normal.squaredNorm() * normal.transpose();
        }
        const double w = std::min(WOf(first, world) / first.row(3).norm(),
                                  WOf(second, world) / second.row(3).norm());
        if (!(w > 0.1) || world.norm() > 20.0) continue;
        const Eigen::Vector3d side = random.UnitVector(), other_side = random.UnitVector();
        const double ratio = DensityByDifferences(first, world, side, other_side) /
                             DensityByDifferences(second, world, side, other_side);
        if (on_plane) {
          EXPECT_NEAR(ratio, 1.0, kDifferences);
          ++num_on_plane;
        } else if (std::abs(ratio - 1.0) > kDifferences) {
          EXPECT_EQ(plane->dot(world.homogeneous()) > 0.0, ratio > 1.0);
          ++num_off;
        }
      }
    }
    EXPECT_GT(num_on_plane, 100);
    EXPECT_GT(num_off, 100);
  }
}

TEST(SeparatingPlane, ContainsTheLight) {
  constexpr double kRounding = 1e-13;  // of its coefficients
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Light light = RandomLight(random, random.Coin());
    const auto plane = SeparatingPlane(RandomMap(light, random), RandomMap(light, random), light);
    ASSERT_THAT(plane, IsOk());
    EXPECT_LE(std::abs(plane->dot(light.HomogeneousPosition())), kRounding * plane->norm());
  }
}

// A_ij of the paper: the 3x3 minor without row i and column j, counted from 1.
double Minor(const Eigen::Matrix4d& matrix, int row, int column) {
  Eigen::Matrix3d rest;
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i == row - 1) continue;
    for (int j = 0, l = 0; j < 4; ++j) {
      if (j != column - 1) rest(k, l++) = matrix(i, j);
    }
    ++k;
  }
  return rest.determinant();
}

// (7): (|det A_34|^(1/3) B_4 - |det B_34|^(1/3) A_4) (X, Y, Z, W)' > 0, of camera space; or with
// another column left out.
Eigen::RowVector4d PlaneOfMinors(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b, int column) {
  return std::cbrt(std::abs(Minor(a, 3, column))) * b.row(3) -
         std::cbrt(std::abs(Minor(b, 3, column))) * a.row(3);
}

TEST(SeparatingPlane, IsThePapersForLampsWhoseMinorsAreZeroForSuns) {
  constexpr double kRounding = 1e-9;  // relative: determinants of rows of different scales
  Random random(3);
  int num_lamps = 0, num_suns = 0;
  for (int i = 0; i < 400; ++i) {
    const bool is_lamp = random.Coin();
    const Light light = RandomLight(random, is_lamp);
    const Eigen::Matrix4d first = RandomMap(light, random), second = RandomMap(light, random);
    Eigen::Matrix4d world_from_camera = Eigen::Matrix4d::Identity();
    world_from_camera.topLeftCorner<3, 3>() = random.Rotation();
    world_from_camera.topRightCorner<3, 1>() = random.InCube(5.0);
    const Eigen::Matrix4d a = first * world_from_camera, b = second * world_from_camera;
    const auto plane = SeparatingPlane(first, second, light);
    ASSERT_THAT(plane, IsOk());
    const Eigen::RowVector4d in_camera = *plane * world_from_camera;
    const double scale = a.row(0).norm() * a.row(1).norm() * a.row(3).norm();
    if (is_lamp) {
      EXPECT_LT(testing::HomogeneousError(in_camera, PlaneOfMinors(a, b, 4)), kRounding);
      ++num_lamps;
      continue;
    }
    EXPECT_LT(std::abs(Minor(a, 3, 4)), 1e-12 * scale);
    // Without row 3 and column 3 they serve, unless the sun lies in the image plane.
    const Eigen::Vector3d sun_in_camera =
        world_from_camera.topLeftCorner<3, 3>().transpose() * light.direction;
    if (std::abs(sun_in_camera.z()) < 0.05) continue;
    EXPECT_LT(testing::HomogeneousError(in_camera, PlaneOfMinors(a, b, 3)), kRounding);
    ++num_suns;
  }
  EXPECT_GT(num_lamps, 100);
  EXPECT_GT(num_suns, 100);
}

TEST(SeparatingPlane, IsTheSameAtAnyScaleOfTheRows) {
  constexpr double kRounding = 1e-12;  // relative
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Light light = RandomLight(random, random.Coin());
    const Eigen::Matrix4d first = RandomMap(light, random), second = RandomMap(light, random);
    const auto plane = SeparatingPlane(first, second, light);
    const auto scaled = SeparatingPlane(7.0 * first, 0.01 * second, light);
    const auto swapped = SeparatingPlane(second, first, light);
    ASSERT_THAT(plane, IsOk());
    ASSERT_THAT(scaled, IsOk());
    ASSERT_THAT(swapped, IsOk());
    EXPECT_LT((*plane - *scaled).norm(), kRounding * (plane->norm() + 1.0));
    EXPECT_EQ(*plane, -*swapped);
  }
}

TEST(SeparatingPlane, NamesAMatrixOfAnotherLight) {
  Random random(5);
  const Light light = Light::Point("lamp", {0.0, 3.0, 0.0});
  const Eigen::Matrix4d good = RandomMap(light, random);
  const Eigen::Matrix4d other = RandomMap(Light::Point("lamp", {1.0, 0.0, 0.0}), random);
  for (const auto& plane :
       {SeparatingPlane(good, other, light), SeparatingPlane(other, good, light)}) {
    EXPECT_THAT(plane, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("lamp")));
  }
}

}  // namespace
}  // namespace lightfit
