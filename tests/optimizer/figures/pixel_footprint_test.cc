#include "optimizer/figures/pixel_footprint.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/testing/gradient_check.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::DepthOnPlane;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlaneReadback;
using testing::Random;
using testing::StatusIs;

struct PlaneCase {
  Camera camera;
  Eigen::Vector3d normal;
  double offset;
  Light light;
  Eigen::Matrix4d map_from_world;

  // Exact: the plane through the camera's ray, projected into the map.
  Eigen::Vector3d MapAt(const Eigen::Vector2d& screen) const {
    const double d = DepthOnPlane(camera, normal, offset, screen)(0);
    const Eigen::Vector4d map =
        map_from_world * camera.WorldFromScreen() * Eigen::Vector4d(screen.x(), screen.y(), d, 1.0);
    return {map.x(), map.y(), map.w()};
  }
  Eigen::Vector2d TexelAt(const Eigen::Vector2d& screen) const {
    return MapAt(screen).hnormalized();
  }
};

// A plane in full view that faces the light, and a map of random warp with w > 0 on it.
PlaneCase RandomPlaneCase(Random& random, bool orthographic, bool directional) {
  while (true) {
    PlaneCase result;
    result.camera = testing::CameraAround(random, 1.0, orthographic);
    result.normal = random.UnitVector();
    result.offset = random.Uniform(-0.2, 0.2);
    const Eigen::Vector3d to_light = random.UnitVector();
    result.light = directional ? Light::Directional("sun", -to_light)
                               : Light::Point("lamp", random.LogUniform(2.0, 50.0) * to_light);
    Eigen::Matrix3d map_from_ray = 400.0 * Eigen::Matrix3d::Identity();
    map_from_ray.topLeftCorner<2, 2>() *= random.Matrix2(5.0);
    map_from_ray.row(2) = Eigen::RowVector3d(
        random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3), random.Uniform(0.5, 1.5));
    result.map_from_world.setZero();
    const Eigen::Matrix<double, 3, 4> rows = map_from_ray * RayFromWorld(result.light, -to_light);
    result.map_from_world << rows.topRows<2>(), Eigen::RowVector4d::Zero(), rows.row(2);

    const Camera& camera = result.camera;
    const Eigen::Vector3d eye = camera.camera_from_world.inverse().topRightCorner<3, 1>();
    const double eye_side = result.normal.dot(eye) - result.offset;
    const double light_side = directional
                                  ? result.normal.dot(to_light)
                                  : result.normal.dot(result.light.position) - result.offset;
    bool usable = eye_side * light_side > 0.0 && std::abs(result.normal.dot(to_light)) > 0.2;
    for (const int x : {0, camera.width}) {
      for (const int y : {0, camera.height}) {
        const double d = DepthOnPlane(camera, result.normal, result.offset, {x, y})(0);
        const double z = orthographic ? d : 1.0 / d;
        usable &= z > 0.5 && z < 10.0 && result.MapAt({x, y}).z() > 0.05;
      }
    }
    if (usable) return result;
  }
}

// math.md (2): the Jacobian is that of the projection through the plane, to the rounding of a float
// depth, whose differences over two pixels carry it.
TEST(PixelFootprints, JacobianIsThatOfTheProjection) {
  Random random(191);
  double worst = 0.0;
  int num_compared = 0;
  for (int i = 0; i < 80; ++i) {
    const PlaneCase plane = RandomPlaneCase(random, i % 2 == 1, i % 4 < 2);
    const PlaneReadback readback(plane.camera, DepthKind::kCameraZ, plane.normal, plane.offset);
    const auto footprints =
        PixelFootprints::Create(readback.View(), plane.light, plane.map_from_world, {});
    ASSERT_THAT(footprints, IsOk());
    for (int k = 0; k < 10; ++k) {
      const int x = random.Int(1, plane.camera.width - 2);
      const int y = random.Int(1, plane.camera.height - 2);
      const auto pixel = footprints->At(x, y);
      if (!pixel.has_value()) continue;  // edge-on
      const Eigen::Vector2d centre(x + 0.5, y + 0.5);
      Eigen::Matrix2d J_map_screen;
      for (int row = 0; row < 2; ++row) {
        J_map_screen.row(row) = testing::CentralDifferences<2>(
            [&](const Eigen::Vector2d& at) { return plane.TexelAt(at)(row); }, centre, 0.05);
      }
      EXPECT_LE((pixel->texel - plane.TexelAt(centre)).norm(), 1e-2);
      // What half a unit in the last place of the depth does to its slope in one pixel.
      const Eigen::Vector3d depth = DepthOnPlane(plane.camera, plane.normal, plane.offset, centre);
      const double slope_error = 0x1p-23 * std::abs(depth(0)) / depth.tail<2>().norm();
      const double error =
          (pixel->J_screen_map * J_map_screen - Eigen::Matrix2d::Identity()).norm();
      EXPECT_LE(error, 1e-5 + 100.0 * slope_error) << i << ", pixel " << x << ", " << y;
      worst = std::max(worst, error);
      ++num_compared;
    }
  }
  std::printf("%d pixels, |J_screen_map J_map_screen - 1| at most %.2g\n", num_compared, worst);
  EXPECT_GE(num_compared, 700);
  EXPECT_LE(worst, 0.02);
}

PlaneReadback Floor() { return testing::FloorReadback(); }
const Light kSun = Light::Directional("sun", {0.3, 0.2, -1.0});

Eigen::Matrix4d FromAbove() {
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
  map_from_world.topLeftCorner<2, 2>() *= 100.0;
  return map_from_world;
}

TEST(PixelFootprints, HasNoneWithoutAPlaneThatFacesTheLight) {
  PlaneReadback readback = Floor();
  readback.depth[readback.Index(10, 10)] = 1e10f;
  readback.depth[readback.Index(20, 10)] = std::nanf("");
  const auto footprints = PixelFootprints::Create(readback.View(), kSun, FromAbove(), {});
  ASSERT_THAT(footprints, IsOk());
  EXPECT_FALSE(footprints->At(10, 10).has_value());
  EXPECT_FALSE(footprints->At(20, 10).has_value());
  EXPECT_TRUE(footprints->At(11, 10).has_value());  // an outline
  EXPECT_FALSE(footprints->At(0, 10).has_value());
  EXPECT_FALSE(footprints->At(39, 10).has_value());
  EXPECT_FALSE(footprints->At(15, 29).has_value());
  for (const Light& light :
       {Light::Directional("below", {0.3, 0.2, 1.0}), Light::Point("cellar", {0.0, 0.0, -2.0})}) {
    const auto from_below = PixelFootprints::Create(readback.View(), light, FromAbove(), {});
    ASSERT_THAT(from_below, IsOk());
    EXPECT_FALSE(from_below->At(15, 15).has_value());
  }
}

TEST(PixelFootprints, SaysWhatIsBehindTheMap) {
  const PlaneReadback readback = Floor();
  Eigen::Matrix4d map_from_world = FromAbove();
  map_from_world.row(1) = Eigen::RowVector4d(0.0, 0.0, 0.0, 100.0);
  map_from_world.row(3) = Eigen::RowVector4d(0.0, 1.0, 0.0, 0.0);  // w = y
  const auto footprints = PixelFootprints::Create(readback.View(), kSun, map_from_world, {});
  ASSERT_THAT(footprints, IsOk());
  EXPECT_TRUE(footprints->At(20, 5).has_value());  // y > 0: the far half of the floor
  EXPECT_TRUE(footprints->At(20, 25)->is_behind);  // y < 0
}

TEST(PixelFootprints, HasNoneWhereTheMapIsSingular) {
  const PlaneReadback readback = Floor();
  Eigen::Matrix4d map_from_world = FromAbove();
  map_from_world.row(1) = map_from_world.row(0);
  const auto footprints = PixelFootprints::Create(readback.View(), kSun, map_from_world, {});
  ASSERT_THAT(footprints, IsOk());
  for (int y = 1; y < 29; ++y) {
    for (int x = 1; x < 39; ++x) {
      const auto pixel = footprints->At(x, y);
      if (!pixel.has_value()) continue;  // rounding may leave a tiny determinant
      EXPECT_TRUE(pixel->J_screen_map.allFinite());
    }
  }
}

TEST(PixelFootprints, RejectsBadInput) {
  const PlaneReadback readback = Floor();
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  Eigen::Matrix4d bad = FromAbove();
  bad(0, 3) = std::nan("");
  EXPECT_THAT(PixelFootprints::Create(readback.View(), kSun, bad, {}).status(),
              StatusIs(kInvalid, HasSubstr("map_from_world")));
  EXPECT_THAT(PixelFootprints::Create(
                  readback.View(), Light::Directional("sun", {0, 0, 0}), FromAbove(), {})
                  .status(),
              StatusIs(kInvalid, HasSubstr("light \"sun\"")));
  Readback view = readback.View();
  view.depth = view.depth.subspan(1);
  EXPECT_THAT(PixelFootprints::Create(view, kSun, FromAbove(), {}).status(),
              StatusIs(kInvalid, HasSubstr("readback.depth")));
}

}  // namespace
}  // namespace lightfit
