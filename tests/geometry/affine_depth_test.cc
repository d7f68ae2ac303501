// AffineDepth: from every kind of depth value to d, and what counts as a surface.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>

#include "geometry/camera.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::CameraAround;
using testing::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr DepthKind kAllKinds[] = {DepthKind::kCameraZ,
                                   DepthKind::kDistance,
                                   DepthKind::kNdcZeroToOne,
                                   DepthKind::kNdcMinusOneToOne,
                                   DepthKind::kNdcReversedZeroToOne};

Camera WithClipPlanes(Camera camera, double near, double far) {
  camera.near = near;
  camera.far = far;
  return camera;
}

// What a renderer would write for a point at planar distance z that is seen at (x, y).
double DepthValue(const Camera& camera, DepthKind kind, const Eigen::Vector3d& in_camera) {
  const double z = in_camera.z();
  const double near = camera.near, far = camera.far;
  const double share = camera.orthographic ? (z - near) / (far - near)
                       : std::isinf(far)   ? 1.0 - near / z
                                           : (1.0 / near - 1.0 / z) / (1.0 / near - 1.0 / far);
  switch (kind) {
    case DepthKind::kCameraZ:
      return z;
    case DepthKind::kDistance:
      return camera.orthographic ? z : in_camera.norm();
    case DepthKind::kNdcZeroToOne:
      return share;
    case DepthKind::kNdcMinusOneToOne:
      return 2.0 * share - 1.0;
    case DepthKind::kNdcReversedZeroToOne:
      return 1.0 - share;
  }
  return kNaN;
}

TEST(AffineDepth, InvertsEveryKindOfDepth) {
  Random random(21);
  for (int i = 0; i < 300; ++i) {
    const bool orthographic = i % 3 == 0;
    const double far = i % 3 == 1 ? kInfinity : 20.0;
    const Camera camera = WithClipPlanes(CameraAround(random, 1.0, orthographic), 0.01, far);
    const int x = random.Int(0, camera.width - 1), y = random.Int(0, camera.height - 1);
    const double z = random.Uniform(0.5, 5.0);
    const Eigen::Vector3d ray =
        camera.screen_from_camera.inverse() * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0);
    const Eigen::Vector3d in_camera =
        orthographic ? Eigen::Vector3d(ray.x(), ray.y(), z) : Eigen::Vector3d(z * ray);
    for (const DepthKind kind : kAllKinds) {
      const double value = DepthValue(camera, kind, in_camera);
      const AffineDepth affine_depth(camera, kind);
      const double d = affine_depth.At(x, y, value);
      EXPECT_NEAR(orthographic ? d : 1.0 / d, z, 1e-11 * z) << DepthKindName(kind);
      EXPECT_TRUE(affine_depth.IsSurface(value)) << DepthKindName(kind) << " " << value;
      EXPECT_FALSE(affine_depth.IsInvalid(value)) << DepthKindName(kind) << " " << value;
    }
  }
}

TEST(AffineDepth, PixelIndependentKindsAreMonotonicInDepth) {
  Random random(22);
  const Camera camera = WithClipPlanes(CameraAround(random, 1.0, false), 0.1, 10.0);
  for (const DepthKind kind : kAllKinds) {
    const AffineDepth affine_depth(camera, kind);
    EXPECT_EQ(affine_depth.is_pixel_independent(), kind != DepthKind::kDistance);
    if (!affine_depth.is_pixel_independent()) continue;
    const double sign = affine_depth.At(0, 0, 0.9) - affine_depth.At(0, 0, 0.1) > 0.0 ? 1.0 : -1.0;
    for (double value = 0.1; value < 0.9; value += 0.1) {
      EXPECT_GT(sign * (affine_depth.At(3, 5, value + 0.05) - affine_depth.At(9, 2, value)), 0.0);
    }
  }
}

struct Classified {
  double value;
  enum { kSurface, kBackground, kInvalid } as;
};

void ExpectClasses(const AffineDepth& affine_depth, std::initializer_list<Classified> values) {
  for (const Classified& classified : values) {
    EXPECT_EQ(affine_depth.IsSurface(classified.value), classified.as == Classified::kSurface)
        << classified.value;
    EXPECT_EQ(affine_depth.IsInvalid(classified.value), classified.as == Classified::kInvalid)
        << classified.value;
  }
}

TEST(AffineDepth, ClassifiesDistances) {
  Random random(23);
  const Camera camera = CameraAround(random, 1.0, false);
  for (const DepthKind kind : {DepthKind::kCameraZ, DepthKind::kDistance}) {
    ExpectClasses(AffineDepth(camera, kind),
                  {{1e-20, Classified::kSurface},
                   {1.0, Classified::kSurface},
                   {0.999 * kBackgroundDepth, Classified::kSurface},
                   {kBackgroundDepth, Classified::kBackground},
                   {1e10, Classified::kBackground},
                   {std::numeric_limits<float>::max(), Classified::kBackground},
                   {kInfinity, Classified::kBackground},
                   {0.0, Classified::kInvalid},
                   {-1.0, Classified::kInvalid},
                   {-kInfinity, Classified::kInvalid},
                   {kNaN, Classified::kInvalid}});
  }
}

TEST(AffineDepth, OrthographicCameraSeesBehindItself) {
  Random random(24);
  ExpectClasses(AffineDepth(CameraAround(random, 1.0, true), DepthKind::kCameraZ),
                {{-3.0, Classified::kSurface},
                 {0.0, Classified::kSurface},
                 {kInfinity, Classified::kBackground},
                 {-kInfinity, Classified::kInvalid},
                 {kNaN, Classified::kInvalid}});
}

TEST(AffineDepth, ClassifiesNdc) {
  Random random(25);
  const Camera camera = WithClipPlanes(CameraAround(random, 1.0, false), 0.1, 10.0);
  ExpectClasses(AffineDepth(camera, DepthKind::kNdcZeroToOne),
                {{0.0, Classified::kSurface},
                 {0.5, Classified::kSurface},
                 {1.0, Classified::kBackground},
                 {1.1, Classified::kInvalid},
                 {-0.1, Classified::kInvalid},
                 {kInfinity, Classified::kInvalid},
                 {kNaN, Classified::kInvalid}});
  ExpectClasses(AffineDepth(camera, DepthKind::kNdcMinusOneToOne),
                {{-1.0, Classified::kSurface},
                 {0.0, Classified::kSurface},
                 {1.0, Classified::kBackground},
                 {1.1, Classified::kInvalid},
                 {-1.1, Classified::kInvalid},
                 {kNaN, Classified::kInvalid}});
  ExpectClasses(AffineDepth(camera, DepthKind::kNdcReversedZeroToOne),
                {{1.0, Classified::kSurface},
                 {0.5, Classified::kSurface},
                 {0.0, Classified::kBackground},
                 {-0.1, Classified::kInvalid},
                 {1.1, Classified::kInvalid},
                 {kNaN, Classified::kInvalid}});
}

TEST(AffineDepth, EveryKindHasAName) {
  for (const DepthKind kind : kAllKinds) EXPECT_STRNE(DepthKindName(kind), "unknown");
}

}  // namespace
}  // namespace lightfit
