#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::CameraAround;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Camera ValidCamera() {
  return *LookAtCamera({4.0, -5.0, 3.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.8, 320, 200);
}

// The pixel and z of a world point, straight from the definition of the intrinsics.
Eigen::Vector3d ProjectByHand(const Camera& camera, const Eigen::Vector3d& world) {
  const Eigen::Vector3d point = (camera.camera_from_world * world.homogeneous()).head<3>();
  const Eigen::Vector3d to_project = camera.orthographic
                                         ? Eigen::Vector3d(point.x(), point.y(), 1.0)
                                         : Eigen::Vector3d(point / point.z());
  const Eigen::Vector3d screen = camera.screen_from_camera * to_project;
  return {screen.x(), screen.y(), point.z()};
}

// The window of an orthographic camera at 10 000 km, in centimetres.
TEST(Camera, WindowsMayBeFarFromTheAxis) {
  Camera camera = ValidCamera();
  camera.orthographic = true;
  for (const double pixels_per_unit : {1e-3, 1.0, 1e3}) {
    camera.screen_from_camera << pixels_per_unit, 0.0, 1e9 * pixels_per_unit,  //
        0.0, -pixels_per_unit, 1e9 * pixels_per_unit,                          //
        0.0, 0.0, 1.0;
    EXPECT_THAT(ValidateCamera(camera), IsOk());
  }
  camera.screen_from_camera.row(1) = 2.0 * camera.screen_from_camera.row(0);
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("singular")));
}

TEST(Camera, WorldFromScreenInvertsDirectProjection) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const double size = random.LogUniform(1e-2, 1e4);
    const Camera camera = CameraAround(random, size, /*orthographic=*/i % 2 == 1);
    const Eigen::Vector3d world = random.InCube(0.5 * size);
    const Eigen::Vector3d projected = ProjectByHand(camera, world);
    const double d = camera.orthographic ? projected.z() : 1.0 / projected.z();
    const Eigen::Vector4d back =
        camera.WorldFromScreen() * Eigen::Vector4d(projected.x(), projected.y(), d, 1.0);
    EXPECT_GT(back.w(), 0.0);
    EXPECT_THAT(Eigen::Vector3d(back.hnormalized()), MatrixNear(world, 1e-11 * size)) << i;
  }
}

TEST(Camera, ScreenFromWorldGivesPixelAndAffineDepthWithPositiveScale) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const double size = random.LogUniform(1e-2, 1e4);
    const Camera camera = CameraAround(random, size, /*orthographic=*/i % 2 == 1);
    const Eigen::Vector3d world = random.InCube(0.5 * size);
    const Eigen::Vector3d projected = ProjectByHand(camera, world);
    const Eigen::Vector4d screen = camera.ScreenFromWorld() * world.homogeneous();
    EXPECT_GT(screen.w(), 0.0);
    const double z = camera.orthographic ? screen.z() / screen.w() : screen.w() / screen.z();
    EXPECT_NEAR(screen.x() / screen.w(), projected.x(), 1e-8);
    EXPECT_NEAR(screen.y() / screen.w(), projected.y(), 1e-8);
    EXPECT_NEAR(z, projected.z(), 1e-10 * size);
  }
}

// math.md (11): d is affine in (x, y) on every plane, for both kinds of camera.
TEST(Camera, AffineDepthIsAffineOnPlanes) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = CameraAround(random, 1.0, /*orthographic=*/i % 2 == 1);
    const Eigen::Vector3d a = random.InCube(0.3), b = random.InCube(0.3), c = random.InCube(0.3);
    const auto screen = [&](const Eigen::Vector3d& world) {
      const Eigen::Vector3d p = ProjectByHand(camera, world);
      return Eigen::Vector3d(p.x(), p.y(), camera.orthographic ? p.z() : 1.0 / p.z());
    };
    Eigen::Matrix3d corners;  // (x, y, 1) of three points of the plane
    corners << screen(a).head<2>().homogeneous(), screen(b).head<2>().homogeneous(),
        screen(c).head<2>().homogeneous();
    if (std::abs(corners.determinant()) < 100.0) continue;  // the plane seen nearly edge-on
    const Eigen::Vector3d inside = screen(0.2 * a + 0.5 * b + 0.3 * c);
    const Eigen::Vector3d weights = corners.inverse() * inside.head<2>().homogeneous();
    const double d = weights.dot(Eigen::Vector3d(screen(a).z(), screen(b).z(), screen(c).z()));
    EXPECT_NEAR(inside.z(), d, 1e-10) << i;
  }
}

TEST(LookAtCamera, PutsTargetInTheMiddleAndUpUpwards) {
  const Camera camera = ValidCamera();
  const Eigen::Vector3d target = ProjectByHand(camera, {0.0, 0.0, 0.0});
  EXPECT_NEAR(target.x(), 160.0, 1e-9);
  EXPECT_NEAR(target.y(), 100.0, 1e-9);
  EXPECT_NEAR(target.z(), Eigen::Vector3d(4.0, -5.0, 3.0).norm(), 1e-12);
  const Eigen::Vector3d above = ProjectByHand(camera, {0.0, 0.0, 0.5});
  EXPECT_NEAR(above.x(), 160.0, 1e-9);
  EXPECT_LT(above.y(), 100.0);
}

TEST(LookAtCamera, VerticalFieldOfViewSpansTheHeight) {
  const Camera camera =
      *LookAtCamera({0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 0.9, 100, 80);
  const Eigen::Vector3d top = ProjectByHand(camera, {0.0, 2.0, 2.0 * std::tan(0.45)});
  EXPECT_NEAR(top.y(), 0.0, 1e-12);
}

TEST(LookAtCamera, RejectsDegenerateViews) {
  const Eigen::Vector3d up(0.0, 0.0, 1.0), eye(1.0, 2.0, 3.0);
  EXPECT_THAT(LookAtCamera(eye, eye, up, 0.8, 10, 10),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("eye and target")));
  EXPECT_THAT(LookAtCamera(eye, eye + up, up, 0.8, 10, 10),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("up is parallel")));
  for (const double fov : {0.0, -1.0, 3.2, kNaN}) {
    EXPECT_THAT(LookAtCamera(eye, {0.0, 0.0, 0.0}, up, fov, 10, 10),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("field of view")));
  }
}

TEST(ValidateCamera, AcceptsMirroredAndInfiniteFarCameras) {
  Camera camera = ValidCamera();
  camera.camera_from_world.row(0) *= -1.0;
  EXPECT_THAT(ValidateCamera(camera), IsOk());
  camera.near = 0.1;
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcReversedZeroToOne), IsOk());
}

TEST(ValidateCamera, RejectsEmptyImage) {
  Camera camera = ValidCamera();
  camera.width = 0;
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera: size = 0x200")));
}

TEST(ValidateCamera, RejectsSingularPose) {
  Camera camera = ValidCamera();
  camera.camera_from_world.row(1) = 2.0 * camera.camera_from_world.row(0);
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera_from_world")));
}

TEST(ValidateCamera, RejectsProjectivePose) {
  Camera camera = ValidCamera();
  camera.camera_from_world(3, 2) = 1.0;
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera_from_world")));
}

TEST(ValidateCamera, RejectsPoseThatIsNotFinite) {
  Camera camera = ValidCamera();
  camera.camera_from_world(0, 3) = kNaN;
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera_from_world")));
}

TEST(ValidateCamera, RejectsSingularIntrinsics) {
  Camera camera = ValidCamera();
  camera.screen_from_camera(0, 0) = 0.0;
  EXPECT_THAT(ValidateCamera(camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("screen_from_camera")));
}

TEST(ValidateCamera, NdcDepthNeedsClipPlanes) {
  Camera camera = ValidCamera();
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kDistance), IsOk());
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcZeroToOne),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("near = 0")));
  camera.near = 2.0;
  camera.far = 1.0;
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcMinusOneToOne),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("near = 2, far = 1")));
  camera.far = kNaN;
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcMinusOneToOne),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("far = nan")));
}

TEST(ValidateCamera, OrthographicNdcNeedsFiniteFar) {
  Camera camera = ValidCamera();
  camera.orthographic = true;
  camera.near = -1.0;
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcZeroToOne),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("far = inf")));
  camera.far = 10.0;
  EXPECT_THAT(ValidateCamera(camera, DepthKind::kNdcZeroToOne), IsOk());
}

}  // namespace
}  // namespace lightfit
