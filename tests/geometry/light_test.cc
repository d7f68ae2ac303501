#include "geometry/light.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::HomogeneousError;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(FrameAlong, IsRightHandedOrthonormalWithThirdAxis) {
  Random random(31);
  for (int i = 0; i < 300; ++i) {
    Eigen::Vector3d third = random.LogUniform(1e-100, 1e100) * random.UnitVector();
    if (i < 3) third = Eigen::Vector3d::Unit(i);
    if (i == 3) third = Eigen::Vector3d(0.0, 0.0, -2.0);
    const Eigen::Matrix3d frame = FrameAlong(third);
    EXPECT_THAT(Eigen::Matrix3d(frame * frame.transpose()),
                MatrixNear(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), 1e-14));
    EXPECT_NEAR(frame.determinant(), 1.0, 1e-14);
    EXPECT_THAT(Eigen::Vector3d(frame.row(2)), MatrixNear(third.normalized().eval(), 1e-15));
  }
}

TEST(RayFromWorld, PointsOnOneRayOfAPointLightHaveParallelRays) {
  Random random(32);
  for (int i = 0; i < 200; ++i) {
    const Light light = Light::Point("lamp", random.InCube(10.0));
    const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light, random.UnitVector());
    const Eigen::Vector3d direction = random.UnitVector();
    const Eigen::Vector3d near = light.position + random.LogUniform(0.1, 10.0) * direction;
    const Eigen::Vector3d far = light.position + random.LogUniform(10.0, 1e3) * direction;
    EXPECT_LT(HomogeneousError(Eigen::Vector3d(ray_from_world * near.homogeneous()),
                               Eigen::Vector3d(ray_from_world * far.homogeneous())),
              1e-12);
  }
}

TEST(RayFromWorld, PointsOnOneRayOfADirectionalLightHaveEqualRays) {
  Random random(33);
  for (int i = 0; i < 200; ++i) {
    const Light light =
        Light::Directional("sun", random.LogUniform(1e-3, 1e3) * random.UnitVector());
    const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
    const Eigen::Vector3d a = random.InCube(10.0);
    const Eigen::Vector3d b = a + random.Uniform(-50.0, 50.0) * light.direction.normalized();
    const Eigen::Vector3d ray = ray_from_world * a.homogeneous();
    EXPECT_EQ(ray.z(), 1.0);
    EXPECT_THAT(Eigen::Vector3d(ray_from_world * b.homogeneous()), MatrixNear(ray, 1e-12));
  }
}

TEST(RayFromWorld, SendsTheLightItselfToZero) {
  Random random(34);
  for (int i = 0; i < 100; ++i) {
    const Light lamp = Light::Point("lamp", random.InCube(100.0));
    const Light sun = Light::Directional("sun", random.UnitVector());
    for (const Light& light : {lamp, sun}) {
      const Eigen::Vector3d ray = RayFromWorld(light) * light.HomogeneousPosition();
      EXPECT_LT(ray.norm(), 1e-13 * light.HomogeneousPosition().norm());
    }
  }
}

TEST(RayFromWorld, ThirdAxisIsForwardForAPointLight) {
  Random random(35);
  const Light light = Light::Point("lamp", {1.0, 2.0, 3.0});
  const Eigen::Vector3d forward = random.UnitVector();
  const Eigen::Vector3d ahead = light.position + 4.0 * forward;
  EXPECT_THAT(Eigen::Vector3d(RayFromWorld(light, 2.0 * forward) * ahead.homogeneous()),
              MatrixNear(Eigen::Vector3d(0.0, 0.0, 4.0), 1e-14));
}

TEST(RayFromWorld, CarriesTheHomogeneousScaleOver) {
  const Light light = Light::Point("lamp", {1.0, 2.0, 3.0});
  const Eigen::Vector4d point(4.0, 5.0, 6.0, 1.0);
  EXPECT_THAT(Eigen::Vector3d(RayFromWorld(light) * (3.0 * point)),
              MatrixNear(Eigen::Vector3d(3.0 * (RayFromWorld(light) * point)), 1e-13));
}

TEST(Light, HomogeneousPositionIsWhereLightComesFrom) {
  EXPECT_EQ(Light::Point("lamp", {1.0, 2.0, 3.0}).HomogeneousPosition(),
            Eigen::Vector4d(1.0, 2.0, 3.0, 1.0));
  EXPECT_EQ(Light::Directional("sun", {0.0, 0.0, -5.0}).HomogeneousPosition(),
            Eigen::Vector4d(0.0, 0.0, 1.0, 0.0));
}

TEST(ValidateLight, AcceptsUnnormalisedDirectionsAndAllBits) {
  EXPECT_THAT(ValidateLight(Light::Directional("sun", {0.0, 0.0, -20.0}, 31)), IsOk());
  EXPECT_THAT(ValidateLight(Light::Point("lamp", {0.0, 0.0, 0.0}, 0)), IsOk());
}

TEST(ValidateLight, NamesTheLightAndItsZeroDirection) {
  EXPECT_THAT(ValidateLight(Light::Directional("sun", {0.0, 0.0, 0.0})),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("light \"sun\""), HasSubstr("direction = (0, 0, 0)"))));
}

TEST(ValidateLight, RejectsDirectionThatIsNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_THAT(
        ValidateLight(Light::Directional("sun", {bad, 0.0, 1.0})),
        StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light \"sun\": direction")));
  }
}

TEST(ValidateLight, RejectsPositionThatIsNotFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_THAT(
        ValidateLight(Light::Point("lamp", {0.0, bad, 1.0})),
        StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light \"lamp\": position")));
  }
}

TEST(ValidateLight, RejectsBitOutOfRange) {
  for (const int bit : {-1, 32}) {
    EXPECT_THAT(ValidateLight(Light::Directional("sun", {0.0, 0.0, -1.0}, bit)),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("shadow_bit = ")));
  }
}

// The smallest and largest directions of double precision still have a direction.
TEST(ValidateLight, AcceptedDirectionsGiveFiniteRays) {
  for (const double length : {1e-320, 1e-200, 1e-160, 1e-150, 1.0, 1e150, 1e300}) {
    const Light light = Light::Directional("sun", {0.0, 0.6 * length, -0.8 * length});
    if (!ValidateLight(light).ok()) continue;
    EXPECT_TRUE(RayFromWorld(light).allFinite()) << length;
    EXPECT_NEAR(light.HomogeneousPosition().norm(), 1.0, 1e-9) << length;
  }
}

}  // namespace
}  // namespace lightfit
