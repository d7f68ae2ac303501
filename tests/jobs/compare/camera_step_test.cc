#include "jobs/compare/camera_step.h"

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

// Poses of some units, in double precision.
constexpr double kRounding = 1e-9;

TEST(ParseCameraStep, ReadsTheWayAndMaybeTurns) {
  const auto step = ParseCameraStep("0.5,-1,2e-1,0.25,-3");
  ASSERT_THAT(step, IsOk());
  EXPECT_EQ(step->forward, 0.5);
  EXPECT_EQ(step->right, -1.0);
  EXPECT_EQ(step->up, 0.2);
  EXPECT_EQ(step->yaw_deg, 0.25);
  EXPECT_EQ(step->pitch_deg, -3.0);
  EXPECT_EQ(ParseCameraStep("1,2,3")->yaw_deg, 0.0);
  for (const char* bad : {"", "1", "1,2", "1,2,x", "1,2,3,4,5,6", "1,2,inf", "nan,0,0", "1,,3"}) {
    EXPECT_THAT(ParseCameraStep(bad),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("FORWARD,RIGHT,UP")))
        << bad;
  }
}

TEST(CameraStepText, SaysWhatMoves) {
  EXPECT_EQ(CameraStepText({}), "none");
  EXPECT_EQ(CameraStepText({0.1, 0, 0, 0.5, 0}), "0.1 forward, 0.5 deg to the right");
  EXPECT_EQ(CameraStepText({-1, -2, -3, -4, -5}),
            "1 back, 2 left, 3 down, 4 deg to the left, 5 deg downwards");
}

// A camera of any kind; the engine's axes may be mirrored.
Camera AnyCamera(Random& random, bool mirrored, bool orthographic) {
  Camera camera = testing::CameraAround(random, 5.0, orthographic);
  if (!mirrored) return camera;
  const Eigen::Vector4d flip(-1.0, 1.0, 1.0, 1.0);
  camera.camera_from_world = flip.asDiagonal() * camera.camera_from_world;
  camera.screen_from_camera = camera.screen_from_camera * flip.head<3>().asDiagonal();
  return camera;
}

Eigen::Vector3d ScreenOf(const Camera& camera, const Eigen::Vector3d& world) {
  return (camera.ScreenFromWorld() * world.homogeneous()).hnormalized();
}

Eigen::Vector3d WorldOf(const Camera& camera, double x, double y, double z) {
  const double d = camera.orthographic ? z : 1.0 / z;
  return (camera.WorldFromScreen() * Eigen::Vector4d(x, y, d, 1.0)).hnormalized();
}

// Where the new camera stands and looks, by points that the old one sees: whatever its axes are.
TEST(Stepped, GoesAndTurnsAsTheImageShowsIt) {
  Random random(471);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const Camera camera = AnyCamera(random, i % 2 == 1, i % 4 >= 2);
    const double x = camera.screen_from_camera(0, 2), y = camera.screen_from_camera(1, 2);
    const Eigen::Vector3d near = WorldOf(camera, x, y, 1.0);
    const Eigen::Vector3d forward = WorldOf(camera, x, y, 2.0) - near;
    const Eigen::Vector3d right = (WorldOf(camera, x + 1.0, y, 1.0) - near).normalized();
    const Eigen::Vector3d up = (WorldOf(camera, x, y - 1.0, 1.0) - near).normalized();
    const CameraStep step = {random.Uniform(-1, 1),
                             random.Uniform(-1, 1),
                             random.Uniform(-1, 1),
                             random.Uniform(-30, 30),
                             random.Uniform(-30, 30)};
    const Camera stepped = Stepped(camera, step);
    EXPECT_THAT(ValidateCamera(stepped), IsOk());
    EXPECT_EQ(stepped.screen_from_camera, camera.screen_from_camera);

    const Eigen::Vector3d eye = near - forward;
    const Eigen::Vector3d new_eye =
        eye + step.forward * forward + step.right * right + step.up * up;
    const double yaw = step.yaw_deg * M_PI / 180.0, pitch = step.pitch_deg * M_PI / 180.0;
    const Eigen::Vector3d level = std::cos(yaw) * forward + std::sin(yaw) * right;
    const Eigen::Vector3d new_forward = std::cos(pitch) * level + std::sin(pitch) * up;
    // The middle of the new image, at a depth of 3, and what is a little up from there.
    EXPECT_THAT(
        ScreenOf(stepped, new_eye + 3.0 * new_forward),
        MatrixNear(Eigen::Vector3d(x, y, camera.orthographic ? 3.0 : 1.0 / 3.0), kRounding * 1e3));
    const Eigen::Vector3d new_up = std::cos(pitch) * up - std::sin(pitch) * level;
    const Eigen::Vector3d above = ScreenOf(stepped, new_eye + 3.0 * new_forward + 0.01 * new_up);
    EXPECT_NEAR(above.x(), x, kRounding * 1e3);
    EXPECT_LT(above.y(), y);
  }
}

TEST(Stepped, NoStepIsTheSameCamera) {
  Random random(472);
  const Camera camera = AnyCamera(random, false, false);
  EXPECT_EQ(Stepped(camera, {}).camera_from_world, camera.camera_from_world);
}

TEST(DefaultCameraStep, IsAtTheScaleOfWhatIsSeen) {
  SurfaceImage image;
  for (const double z : {5.0, 900.0, 40.0}) {
    SurfacePoint pixel;
    pixel.triangle = 0;
    pixel.camera_z = z;
    image.pixels.push_back(pixel);
  }
  image.pixels.emplace_back();  // background
  image.num_surface = 3;
  EXPECT_DOUBLE_EQ(DefaultCameraStep(image).forward, 0.4);
  EXPECT_EQ(DefaultCameraStep(image).yaw_deg, 0.5);
  EXPECT_EQ(DefaultCameraStep(SurfaceImage()).forward, 0.0);
}

}  // namespace
}  // namespace lightfit
