#include "partition/shipped/paraboloid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;

constexpr double kRounding = 1e-12;
constexpr double kDifferences = 1e-8;  // of central differences with a step of 1e-6

// A direction of a half, its rim included now and then.
Eigen::Vector3d InHalf(Random& random) {
  Eigen::Vector3d d = random.UnitVector();
  d.z() = random.Int(0, 9) == 0 ? 0.0 : std::abs(d.z());
  return d.normalized();
}

ParaboloidPair RandomPair(Random& random, int size = 256) {
  const Light light = Light::Point("lamp", random.InCube(5.0));
  return *MakeParaboloidPair(light, 3.0 * random.UnitVector(), int64_t{2} * size * size);
}

// d(uv)/d(direction) along two orthonormal directions across d.
Eigen::Matrix2d JacobianAt(const Eigen::Vector3d& d) {
  constexpr double kStep = 1e-6;
  const Eigen::Matrix3d frame = FrameAlong(d);
  Eigen::Matrix2d jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector3d step = kStep * frame.row(axis).transpose();
    jacobian.col(axis) = (ParaboloidFromDirection((d + step).normalized()) -
                          ParaboloidFromDirection((d - step).normalized())) /
                         (2.0 * kStep);
  }
  return jacobian;
}

TEST(Paraboloid, IsConformalOfADensityFromAQuarterToOne) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d d = InHalf(random);
    const Eigen::Matrix2d jacobian = JacobianAt(d);
    const double density = ParaboloidDensity(d.z());
    EXPECT_THAT(jacobian.transpose() * jacobian,
                MatrixNear(density * Eigen::Matrix2d::Identity(), kDifferences));
    // FrameAlong(d) has d as its third axis, so the map is not mirrored as the light sees it.
    EXPECT_NEAR(jacobian.determinant(), density, kDifferences);
  }
  EXPECT_EQ(ParaboloidDensity(1.0), 0.25);
  EXPECT_EQ(ParaboloidDensity(0.0), 1.0);
  EXPECT_NEAR(JacobianAt({0.0, 0.0, 1.0}).determinant(), 0.25, kDifferences);
  EXPECT_NEAR(JacobianAt({0.6, -0.8, 0.0}).determinant(), 1.0, kDifferences);
}

TEST(Paraboloid, IsUndoneByItsInverse) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d d = InHalf(random);
    const Eigen::Vector2d uv = ParaboloidFromDirection(d);
    EXPECT_LE(uv.norm(), 1.0 + kRounding);
    EXPECT_THAT(DirectionFromParaboloid(uv), MatrixNear(d, kRounding));
    // Beyond the rim too, where texels' centres may lie.
    const Eigen::Vector2d beyond(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0));
    EXPECT_THAT(ParaboloidFromDirection(DirectionFromParaboloid(beyond)),
                MatrixNear(beyond, kRounding));
    EXPECT_NEAR(DirectionFromParaboloid(beyond).norm(), 1.0, kRounding);
  }
}

TEST(ParaboloidPair, AsksTheHalfOnTheReceiversSideAndItsRayGoesThere) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const ParaboloidPair pair = RandomPair(random);
    EXPECT_NEAR(pair.normal.norm(), 1.0, kRounding);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d d = random.UnitVector();
      const Eigen::Vector3d world = pair.centre + random.LogUniform(1e-3, 1e3) * d;
      const ParaboloidPlace place = pair.At(world);
      EXPECT_EQ(place.half, pair.normal.dot(d) >= 0.0 ? 0 : 1);
      // In the disc.
      EXPECT_LE((place.texel - Eigen::Vector2d::Constant(128.0)).norm(), 128.0 + 1e-9);
      const TexelRay ray = pair.RayAt(place);
      EXPECT_EQ(ray.origin, pair.centre);
      EXPECT_THAT(ray.direction, MatrixNear(d, 1e-11));
      // The ray of the texel's centre is looked up in the texel, or across the rim.
      ParaboloidPlace centre = place;
      centre.texel = place.texel.array().floor() + 0.5;
      const ParaboloidPlace again = pair.At(pair.centre + pair.RayAt(centre).direction);
      if (again.half == place.half) {
        EXPECT_THAT(again.texel, MatrixNear(centre.texel, 1e-9));
      } else {
        EXPECT_GT((centre.texel - Eigen::Vector2d::Constant(128.0)).norm(), 128.0 - 1e-9);
      }
    }
    EXPECT_EQ(pair.At(pair.centre).half, -1);
  }
}

// (S / 8) / (1 + |d_z|)^2 texels per steradian of S in all, and pi / 4 of the squares used.
TEST(ParaboloidPair, HasItsDensityOverTheWholeSphere) {
  Random random(3);
  const ParaboloidPair pair = RandomPair(random);
  const double texels = static_cast<double>(NumTexels(pair));
  EXPECT_EQ(texels, 2 * 256 * 256);
  // Each half's mean density times its solid angle, by the midpoint rule over d_z.
  double used = 0.0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const double d_z = (i + 0.5) / kSteps;
    used += 2.0 * 2.0 * M_PI / kSteps * (texels / 8.0) * ParaboloidDensity(d_z);
  }
  EXPECT_NEAR(used / texels, M_PI / 4.0, 1e-6);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d d = random.UnitVector();
    const double d_z = std::abs(pair.normal.dot(d));
    if (d_z < 1e-3) continue;  // differences across the seam
    const Eigen::Matrix3d frame = FrameAlong(d);
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector3d step = kStep * frame.row(axis).transpose();
      jacobian.col(axis) = (pair.At(pair.centre + (d + step).normalized()).texel -
                            pair.At(pair.centre + (d - step).normalized()).texel) /
                           (2.0 * kStep);
    }
    EXPECT_NEAR(jacobian.determinant() / (texels / 8.0 * ParaboloidDensity(d_z)), 1.0, 1e-5);
  }
}

TEST(ParaboloidPair, IsContinuousAcrossItsSeam) {
  constexpr double kAside = 1e-9;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const ParaboloidPair pair = RandomPair(random);
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d rim = pair.normal.cross(random.UnitVector()).normalized();
      const ParaboloidPlace above = pair.At(pair.centre + rim + kAside * pair.normal);
      const ParaboloidPlace below = pair.At(pair.centre + rim - kAside * pair.normal);
      EXPECT_EQ(above.half, 0);
      EXPECT_EQ(below.half, 1);
      // The rim's points are the same ones, mirrored across u.
      EXPECT_NEAR(above.texel.x(), below.texel.x(), 1e-6);
      EXPECT_NEAR(above.texel.y(), 256.0 - below.texel.y(), 1e-6);
      EXPECT_THAT(pair.RayAt(above).direction,
                  MatrixNear(pair.RayAt(below).direction, 4.0 * kAside));
    }
  }
}

TEST(ParaboloidPair, FiltersTexelsInsideAndDirectionsAcrossTheSeam) {
  Random random(5);
  const ParaboloidPair pair = RandomPair(random, 512);
  std::vector<Eigen::Vector2d> kernel;
  for (const double u : {-2.0, 0.0, 2.0}) {
    for (const double v : {-2.0, 0.0, 2.0}) kernel.emplace_back(u, v);
  }
  int num_crossing = 0;
  for (int i = 0; i < 500; ++i) {
    Eigen::Vector3d d = random.UnitVector();
    if (i % 2 == 0)
      d -= (1.0 - 1e-3 * random.Uniform(-1.0, 1.0)) * d.dot(pair.normal) * pair.normal;
    const Eigen::Vector3d world = pair.centre + 2.0 * d;
    const ParaboloidPlace middle = pair.At(world);
    const std::vector<ParaboloidPlace> places = pair.FilterAt(world, kernel);
    ASSERT_EQ(places.size(), kernel.size());
    // A texel's angle here: 2 (1 + d_z) / size.
    const double d_z = std::abs(d.normalized().dot(pair.normal));
    const double texel_rad = 2.0 * (1.0 + d_z) / pair.size;
    for (size_t k = 0; k < kernel.size(); ++k) {
      const ParaboloidPlace& place = places[k];
      EXPECT_LE((place.texel - Eigen::Vector2d::Constant(256.0)).norm(), 256.0 + 1e-9);
      const Eigen::Vector3d there = pair.RayAt(place).direction;
      EXPECT_EQ(place.half, pair.normal.dot(there) >= 0.0 ? 0 : 1);
      // As far away as the offset says, whichever half it is in: to the second order of the angle.
      const double angle =
          std::atan2(there.cross(d.normalized()).norm(), there.dot(d.normalized()));
      EXPECT_NEAR(angle, kernel[k].norm() * texel_rad, 2.0 * std::pow(3.0 * texel_rad, 2));
      if (place.half == middle.half) {
        EXPECT_THAT(place.texel - middle.texel, MatrixNear(kernel[k], 0.05));
      } else {
        ++num_crossing;
      }
    }
  }
  EXPECT_GT(num_crossing, 100);
  EXPECT_TRUE(pair.FilterAt(pair.centre, kernel).empty());
}

TEST(MakeParaboloidPair, KeepsTheBudgetAndSaysWhatIsWrong) {
  const Light lamp = Light::Point("lamp", {1.0, 2.0, 3.0});
  const auto pair = MakeParaboloidPair(lamp, {0.0, 0.0, -2.0}, 1001);
  ASSERT_THAT(pair, IsOk());
  EXPECT_EQ(pair->size, 22);
  EXPECT_EQ(NumTexels(*pair), 968);
  EXPECT_EQ(pair->normal, -Eigen::Vector3d::UnitZ());
  EXPECT_THAT(MakeParaboloidPair(Light::Directional("sun", {0.0, 0.0, -1.0}), {0, 0, 1}, 1000),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cascades are for it")));
  EXPECT_THAT(MakeParaboloidPair(lamp, {0, 0, 0}, 1000),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("normal = (0, 0, 0)")));
  EXPECT_THAT(MakeParaboloidPair(lamp, {0, std::nan(""), 0}, 1000),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("nan")));
  EXPECT_THAT(MakeParaboloidPair(lamp, {0, 0, 1}, 1),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("at least 2")));
}

}  // namespace
}  // namespace lightfit
