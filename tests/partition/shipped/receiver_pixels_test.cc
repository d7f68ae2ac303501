#include "partition/shipped/receiver_pixels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stop_token>

#include "base/stop.h"
#include "methods/view_body.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::MatrixNear;

// Where the eye's ray through a screen point meets the plane n.x = offset.
Eigen::Vector3d OnPlane(
    const Camera& camera, const Eigen::Vector3d& normal, double offset, double x, double y) {
  const Eigen::Vector3d eye = EyePosition(camera);
  const Eigen::Vector3d ray = camera.camera_from_world.topLeftCorner<3, 3>().transpose() *
                              camera.screen_from_camera.inverse() * Eigen::Vector3d(x, y, 1.0);
  return eye + (offset - normal.dot(eye)) / normal.dot(ray) * ray;
}

TEST(ReceiverPixels, HaveTheirCornersOnTheirOwnPlane) {
  constexpr double kTolerance = 1e-5;  // metres: depth is in single precision
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  int num_pixels = 0;
  ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
    ++num_pixels;
    const auto at = [&](double x, double y) {
      return OnPlane(floor.camera, Eigen::Vector3d::UnitZ(), 0.0, x, y);
    };
    const double x = pixel.x, y = pixel.y;
    EXPECT_THAT(pixel.points[0], MatrixNear(at(x + 0.5, y + 0.5), kTolerance));
    // In the outermost rows and columns no plane is known.
    if (pixel.x == 0 || pixel.y == 0 || pixel.x + 1 == floor.camera.width ||
        pixel.y + 1 == floor.camera.height) {
      return;
    }
    EXPECT_THAT(pixel.points[1], MatrixNear(at(x, y), kTolerance));
    EXPECT_THAT(pixel.points[2], MatrixNear(at(x + 1.0, y), kTolerance));
    EXPECT_THAT(pixel.points[3], MatrixNear(at(x + 1.0, y + 1.0), kTolerance));
    EXPECT_THAT(pixel.points[4], MatrixNear(at(x, y + 1.0), kTolerance));
  });
  EXPECT_EQ(num_pixels, floor.camera.width * floor.camera.height);
}

TEST(ReceiverPixels, AreThoseThatShowASurfaceAndLieAboutTheirMiddle) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const testing::TestScene scene(seed, 1);
    const Readback readback = scene.View();
    const auto surfaces = FindSurfaces(readback, 1, {});
    ASSERT_THAT(surfaces, IsOk());
    int num_pixels = 0;
    ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
      ++num_pixels;
      const double depth = readback.depth[readback.Index(pixel.x, pixel.y)];
      EXPECT_NEAR(CameraDepth(readback.camera, pixel.points[0]), depth, 1e-5 * depth);
      for (const Eigen::Vector3d& point : pixel.points) {
        EXPECT_TRUE(point.allFinite());
        const double there = CameraDepth(readback.camera, point);
        EXPECT_GE(there, 0.499 * depth);
        EXPECT_LE(there, 2.001 * depth);
      }
    });
    EXPECT_EQ(num_pixels, surfaces->tiles.num_surfaces);
  }
}

TEST(ReceiverPixels, OfAnOrthographicViewMayLieBehindIt) {
  Camera camera = testing::FloorCamera(20, 16);
  camera.orthographic = true;
  camera.screen_from_camera(0, 0) = camera.screen_from_camera(1, 1) = 4.0;
  // Move the eye down along the view until half of the floor is behind it.
  camera.camera_from_world(2, 3) = 0.0;
  const testing::PlaneReadback floor = testing::FloorReadback(camera);
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  int num_behind = 0;
  ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
    num_behind += CameraDepth(camera, pixel.points[0]) < 0.0 ? 1 : 0;
    if (pixel.x == 0 || pixel.y == 0 || pixel.x == 19 || pixel.y == 15) return;
    for (const Eigen::Vector3d& point : pixel.points) EXPECT_NEAR(point.z(), 0.0, 1e-5);
  });
  EXPECT_GT(num_behind, 50);
}

TEST(ReceiverPixels, EndWhereAStopIsAskedFor) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  std::stop_source source;
  const StopScope scope(source.get_token());
  int num_pixels = 0;
  ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel&) {
    ++num_pixels;
    source.request_stop();
  });
  EXPECT_EQ(num_pixels, floor.camera.width);
}

}  // namespace
}  // namespace lightfit
