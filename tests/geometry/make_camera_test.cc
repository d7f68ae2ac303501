// MakeCamera() against matrices built as each graphics interface documents them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "geometry/affine_depth.h"
#include "geometry/camera.h"
#include "geometry/clip.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

constexpr double kNear = 0.25, kFar = 80.0;

struct Engine {
  const char* name;
  ClipConvention clip;
  DepthKind kind;
  double forward;  // the sign of z in front of the camera, in the engine's camera space
  bool y_up;       // whether clip y = +1 is the top of the image
  double ndc_near, ndc_far;
};

const Engine kEngines[] = {
    {"OpenGL", ClipConvention::OpenGl(), DepthKind::kNdcMinusOneToOne, -1.0, true, -1.0, 1.0},
    {"Vulkan", ClipConvention::Vulkan(), DepthKind::kNdcZeroToOne, 1.0, false, 0.0, 1.0},
    {"Vulkan -z", ClipConvention::Vulkan(), DepthKind::kNdcZeroToOne, -1.0, false, 0.0, 1.0},
    {"Direct3D", ClipConvention::Direct3D(), DepthKind::kNdcZeroToOne, 1.0, true, 0.0, 1.0},
    {"reversed z",
     ClipConvention::ReversedZ(),
     DepthKind::kNdcReversedZeroToOne,
     1.0,
     false,
     1.0,
     0.0},
    {"Direct3D reversed",
     ClipConvention::Direct3DReversed(),
     DepthKind::kNdcReversedZeroToOne,
     1.0,
     true,
     1.0,
     0.0},
    {"Metal reversed -z",
     ClipConvention::Direct3DReversed(),
     DepthKind::kNdcReversedZeroToOne,
     -1.0,
     true,
     1.0,
     0.0},
};

// x, y scaled and moved off centre; the depth row solves ndc(near), ndc(far).
Eigen::Matrix4d Perspective(const Engine& engine, double far) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = 1.3;
  m(1, 1) = 1.9;
  m(0, 2) = 0.21 * engine.forward;
  m(1, 2) = -0.34 * engine.forward;
  m(3, 2) = engine.forward;
  // ndc = a + b / z.
  const double inverse_far = 1.0 / far;
  const double b = (engine.ndc_near - engine.ndc_far) / (1.0 / kNear - inverse_far);
  m(2, 2) = engine.forward * (engine.ndc_near - b / kNear);
  m(2, 3) = b;
  return m;
}

Eigen::Matrix4d Orthographic(const Engine& engine) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m(0, 0) = 0.13;
  m(1, 1) = 0.19;
  m(0, 3) = 0.21;
  m(1, 3) = -0.34;
  // ndc = a z + b.
  const double a = (engine.ndc_far - engine.ndc_near) / (kFar - kNear);
  m(2, 2) = engine.forward * a;
  m(2, 3) = engine.ndc_near - a * kNear;
  return m;
}

Eigen::Matrix4d Pose(Random& random) {
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = random.Rotation();
  pose.topRightCorner<3, 1>() = random.InCube(5.0);
  return pose;
}

// Projects points through the engine's own matrices and through the camera: the same pixel, and
// the depth buffer's value gives the same point back.
void ExpectSameProjection(const Engine& engine,
                          const Eigen::Matrix4d& projection,
                          bool orthographic,
                          Random& random) {
  constexpr int kWidth = 320, kHeight = 180;
  const Eigen::Matrix4d pose = Pose(random);
  const absl::StatusOr<Camera> camera = MakeCamera(pose, projection, engine.clip, kWidth, kHeight);
  ASSERT_THAT(camera, IsOk()) << engine.name;
  EXPECT_EQ(camera->orthographic, orthographic);
  EXPECT_THAT(ValidateCamera(*camera, engine.kind), IsOk());
  const AffineDepth affine_depth(*camera, engine.kind);
  for (int i = 0; i < 20; ++i) {
    const double z = random.Uniform(0.5, 40.0);
    const Eigen::Vector4d in_camera(
        random.Uniform(-0.4, 0.4) * z, random.Uniform(-0.4, 0.4) * z, engine.forward * z, 1.0);
    const Eigen::Vector4d world = pose.inverse() * in_camera;
    const Eigen::Vector4d clip = projection * in_camera;
    ASSERT_GT(clip.w(), 0.0);
    const Eigen::Vector3d ndc = clip.hnormalized();
    const double pixel_x = 0.5 * kWidth * (1.0 + ndc.x());
    const double pixel_y = 0.5 * kHeight * (1.0 + (engine.y_up ? -1.0 : 1.0) * ndc.y());

    const Eigen::Vector4d screen = camera->ScreenFromWorld() * world;
    EXPECT_GT(screen.w(), 0.0);
    EXPECT_NEAR(screen.x() / screen.w(), pixel_x, 1e-8) << engine.name;
    EXPECT_NEAR(screen.y() / screen.w(), pixel_y, 1e-8) << engine.name;
    const double d = affine_depth.At(0, 0, ndc.z());
    EXPECT_NEAR(orthographic ? d : 1.0 / d, z, 1e-9 * z) << engine.name;
    EXPECT_TRUE(affine_depth.IsSurface(ndc.z())) << engine.name;
    const Eigen::Vector4d back =
        camera->WorldFromScreen() * Eigen::Vector4d(pixel_x, pixel_y, d, 1);
    EXPECT_LT((back.hnormalized() - world.hnormalized()).norm(), 1e-9 * z) << engine.name;
  }
}

TEST(MakeCamera, MatchesPerspectiveOffCentre) {
  Random random(11);
  for (const Engine& engine : kEngines) {
    ExpectSameProjection(engine, Perspective(engine, kFar), /*orthographic=*/false, random);
  }
}

TEST(MakeCamera, MatchesOrthographicOffCentre) {
  Random random(12);
  for (const Engine& engine : kEngines) {
    ExpectSameProjection(engine, Orthographic(engine), /*orthographic=*/true, random);
  }
}

TEST(MakeCamera, MatchesInfiniteFarPlane) {
  Random random(13);
  for (const Engine& engine : kEngines) {
    const double infinity = std::numeric_limits<double>::infinity();
    ExpectSameProjection(engine, Perspective(engine, infinity), /*orthographic=*/false, random);
  }
}

TEST(MakeCamera, RecoversClipPlanes) {
  Random random(14);
  for (const Engine& engine : kEngines) {
    const Camera perspective =
        *MakeCamera(Pose(random), Perspective(engine, kFar), engine.clip, 64, 64);
    EXPECT_NEAR(perspective.near, kNear, 1e-12) << engine.name;
    EXPECT_NEAR(perspective.far, kFar, 1e-7) << engine.name;
    const Camera orthographic =
        *MakeCamera(Pose(random), Orthographic(engine), engine.clip, 64, 64);
    EXPECT_NEAR(orthographic.near, kNear, 1e-12) << engine.name;
    EXPECT_NEAR(orthographic.far, kFar, 1e-10) << engine.name;
    const double infinity = std::numeric_limits<double>::infinity();
    const Camera endless =
        *MakeCamera(Pose(random), Perspective(engine, infinity), engine.clip, 64, 64);
    EXPECT_GT(endless.far, 1e12) << engine.name;
  }
}

TEST(MakeCamera, ExplainsRowVectorProjection) {
  for (const Engine& engine : kEngines) {
    for (const Eigen::Matrix4d& projection : {Perspective(engine, kFar), Orthographic(engine)}) {
      const Eigen::Matrix4d transposed = projection.transpose();
      EXPECT_THAT(MakeCamera(Eigen::Matrix4d::Identity(), transposed, engine.clip, 4, 4),
                  StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("transpose")))
          << engine.name << "\n"
          << transposed;
    }
  }
}

TEST(MakeCamera, RejectsProjectionThatIsNotFinite) {
  Eigen::Matrix4d projection = Perspective(kEngines[0], kFar);
  projection(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(MakeCamera(Eigen::Matrix4d::Identity(), projection, ClipConvention::OpenGl(), 4, 4),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not finite")));
}

TEST(MakeCamera, RejectsEmptyImageAndSingularPose) {
  const Eigen::Matrix4d projection = Perspective(kEngines[0], kFar);
  EXPECT_THAT(MakeCamera(Eigen::Matrix4d::Identity(), projection, ClipConvention::OpenGl(), 0, 4),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("size = 0x4")));
  EXPECT_THAT(MakeCamera(Eigen::Matrix4d::Zero(), projection, ClipConvention::OpenGl(), 4, 4),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera_from_world")));
}

}  // namespace
}  // namespace lightfit
