#include "partition/shipped/stable_cascades.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "methods/view_body.h"
#include "partition/shipped/cascade_parts.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// A perspective or orthographic camera with clip planes, its optical axis off the image's middle.
Camera RandomView(Random& random, bool orthographic = false) {
  Camera camera = testing::CameraAround(random, 5.0, orthographic);
  camera.near = random.LogUniform(0.05, 1.0);
  camera.far = camera.near * random.LogUniform(3.0, 1000.0);
  return camera;
}

// The same lens somewhere else.
Camera Moved(Random& random, Camera camera) {
  Eigen::Matrix4d moved_from_world = Eigen::Matrix4d::Identity();
  moved_from_world.topLeftCorner<3, 3>() = random.Rotation();
  moved_from_world.topRightCorner<3, 1>() = random.InCube(50.0);
  camera.camera_from_world *= moved_from_world;
  return camera;
}

StableCascadesOptions RandomOptions(Random& random) {
  StableCascadesOptions options;
  options.num_maps = random.Int(1, 8);
  options.lambda = random.Uniform(0.0, 1.0);
  options.margin_texels = random.Coin() ? 0.0 : random.Uniform(0.0, 5.0);
  return options;
}

TEST(StableCascades, KeepEveryTexelWhereItIsWhenTheCameraMovesAndTurns) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    const Light light = Light::Directional("sun", random.UnitVector());
    const Camera camera = RandomView(random);
    const StableCascadesOptions options = RandomOptions(random);
    const auto before = StableCascades(light, camera, 500'000, options);
    ASSERT_THAT(before, IsOk());
    for (int i = 0; i < 10; ++i) {
      const auto after = StableCascades(light, Moved(random, camera), 500'000, options);
      ASSERT_THAT(after, IsOk());
      for (int k = 0; k < options.num_maps; ++k) {
        const Eigen::Matrix4d& a = before->maps[k].map_from_world;
        const Eigen::Matrix4d& b = after->maps[k].map_from_world;
        EXPECT_EQ(before->maps[k].size.width, after->maps[k].size.width);
        for (const int row : {0, 1}) {
          // The same texels, to the last bit, but for a move by whole ones.
          EXPECT_EQ((a.row(row) - b.row(row)).head<3>().norm(), 0.0);
          const double move = a(row, 3) - b(row, 3);
          EXPECT_EQ(move, std::round(move));
        }
        EXPECT_EQ(a.row(3), Eigen::RowVector4d::UnitW());
        EXPECT_EQ(b.row(3), Eigen::RowVector4d::UnitW());
      }
    }
  }
}

TEST(StableCascades, HoldEveryPointOfTheViewInTheMapOfItsPart) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const Light light = Light::Directional("sun", random.UnitVector());
    const Camera camera = RandomView(random, seed % 4 == 0);
    const StableCascadesOptions options = RandomOptions(random);
    const auto plan = StableCascades(light, camera, 100'000, options);
    ASSERT_THAT(plan, IsOk());
    EXPECT_LE(NumTexels(*plan), 100'000);
    // A filter of the margin stays inside as well.
    const auto look_up = PlanLookUp::Create(*plan, light, options.margin_texels);
    ASSERT_THAT(look_up, IsOk());
    const std::vector<double> splits =
        CascadeSplits(camera.near, camera.far, options.num_maps, options.lambda);
    const Eigen::Matrix4d world_from_screen = camera.WorldFromScreen();
    for (int i = 0; i < 300; ++i) {
      const int part = random.Int(0, options.num_maps - 1);
      // Corners of the slice are as likely as what is between them.
      const auto share = [&random] { return std::clamp(random.Uniform(-0.5, 1.5), 0.0, 1.0); };
      const double x = share() * camera.width, y = share() * camera.height;
      const double z =
          splits[part] + (1e-9 + (1.0 - 2e-9) * share()) * (splits[part + 1] - splits[part]);
      const double d = camera.orthographic ? z : 1.0 / z;
      const Eigen::Vector3d world =
          (world_from_screen * Eigen::Vector4d(x, y, d, 1.0)).hnormalized();
      EXPECT_EQ(look_up->At(world).map, part) << "x " << x << " y " << y << " z " << z;
      const Eigen::Vector4d at = plan->maps[part].map_from_world * world.homogeneous();
      EXPECT_GE(at.z(), -1e-9);
      EXPECT_LE(at.z(), 1.0 + 1e-9);
    }
  }
}

TEST(StableCascades, ServeTheReceiversBeyondTheClipPlanesInTheOutermostParts) {
  Random random(3);
  const Light light = Light::Directional("sun", {0.1, 0.2, -1.0});
  const Camera camera = RandomView(random);
  const auto plan = StableCascades(light, camera, 100'000, {});
  ASSERT_THAT(plan, IsOk());
  ASSERT_EQ(plan->maps.size(), 4u);
  EXPECT_EQ(plan->maps.front().half_spaces.size(), 1u);
  EXPECT_EQ(plan->maps[1].half_spaces.size(), 2u);
  EXPECT_EQ(plan->maps.back().half_spaces.size(), 1u);
}

TEST(SphereAroundSlice, IsTheClosedFormWhereTheLensIsSymmetric) {
  constexpr double kTolerance = 1e-9;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Camera camera = RandomView(random);
    camera.screen_from_camera(0, 2) = 0.5 * camera.width;
    camera.screen_from_camera(1, 2) = 0.5 * camera.height;
    const double focal = camera.screen_from_camera(0, 0);
    // Tangent of half of the diagonal field of view, squared.
    const double k = 0.25 * (std::pow(camera.width, 2) / std::pow(focal, 2) +
                             std::pow(camera.height / camera.screen_from_camera(1, 1), 2));
    const double near = camera.near, far = camera.near * random.LogUniform(1.1, 50.0);
    const double z = std::min(far, 0.5 * (near + far) * (1.0 + k));
    const SliceSphere sphere = SphereAroundSlice(camera, near, far);
    EXPECT_NEAR(sphere.centre.z(), z, kTolerance * far);
    EXPECT_NEAR(sphere.centre.head<2>().norm(), 0.0, kTolerance * far);
    EXPECT_NEAR(sphere.radius, std::hypot(far - z, std::sqrt(k) * far), kTolerance * far);
  }
}

TEST(SphereAroundSlice, IsTheSmallestOfItsLineForAnyLens) {
  constexpr double kTolerance = 1e-9;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Camera camera = RandomView(random, seed % 3 == 0);
    camera.far = camera.near * random.LogUniform(1.1, 50.0);
    camera.camera_from_world.setIdentity();
    const SliceSphere sphere = SphereAroundSlice(camera, camera.near, camera.far);
    const auto corners = FrustumCorners(camera);
    const auto radius_at = [&corners](const Eigen::Vector3d& centre) {
      double radius = 0.0;
      for (const Eigen::Vector3d& corner : corners) {
        radius = std::max(radius, (corner - centre).norm());
      }
      return radius;
    };
    EXPECT_NEAR(radius_at(sphere.centre), sphere.radius, kTolerance * sphere.radius);
    const Eigen::Vector3d begin = 0.5 * (corners[0] + corners[2]);
    const Eigen::Vector3d end = 0.5 * (corners[4] + corners[6]);
    double least = std::numeric_limits<double>::infinity();
    for (int i = -1000; i <= 3000; ++i) {
      least = std::min(least, radius_at(begin + i / 1000.0 * (end - begin)));
    }
    EXPECT_LE(sphere.radius, least * (1.0 + kTolerance));
    EXPECT_GE(sphere.radius, least * (1.0 - 1e-3));  // the steps of the search
  }
}

TEST(StableCascades, SayWhatIsWrong) {
  Random random(4);
  const Light sun = Light::Directional("sun", {0.0, 0.0, -1.0});
  Camera camera = RandomView(random);
  EXPECT_THAT(StableCascades(Light::Point("lamp", {0.0, 0.0, 3.0}), camera, 1000),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       ::testing::AllOf(HasSubstr("lamp"), HasSubstr("CubeFaces"))));
  EXPECT_THAT(StableCascades(sun, camera, 15),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("want at least 16")));
  StableCascadesOptions options;
  options.num_maps = 33;
  EXPECT_THAT(
      StableCascades(sun, camera, 1000, options),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("num_maps = 33, want 1 ... 32")));
  options = {};
  options.lambda = std::nan("");
  EXPECT_THAT(StableCascades(sun, camera, 1000, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("lambda = nan")));
  options = {};
  options.margin_texels = -1.0;
  EXPECT_THAT(StableCascades(sun, camera, 1000, options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("margin_texels = -1")));
  camera.far = std::numeric_limits<double>::infinity();
  EXPECT_THAT(StableCascades(sun, camera, 1000),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("far = inf")));
}

}  // namespace
}  // namespace lightfit
