// Which points count: those that both frames see, inside both maps.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "optimizer/figures/stability.h"
#include "optimizer/fit.h"
#include "tests/optimizer/figures/floor_crawl.h"
#include "tests/testing/box_scene.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::FloorMap;
using testing::FloorReadback;
using testing::kMap;
using testing::kSun;
using testing::Measured;
using testing::PlaneReadback;
using testing::ShadowedFloor;
using testing::Shifted;

// What the hundreds of points of a small frame leave of the root mean square.
constexpr double kStatistical = 0.02;

// Every pixel of the earlier frame, its surface cast anew into the later by the scene itself.
TEST(MeasureCrawl, IsThatOfEveryPixelByBruteForce) {
  int num_scenes = 0;
  double worst = 0.0;
  for (uint64_t seed = 431; seed < 439; ++seed) {
    std::printf("seed %d\n", static_cast<int>(seed));
    const BoxScene scene = MakeBoxScene(seed);
    const Light light = RandomLight(scene, seed, RandomLightKind::kSun);
    const Camera first = RandomCamera(scene, seed, 96, 64);
    Camera second = first;
    second.camera_from_world.topRightCorner<3, 1>() -= Eigen::Vector3d(0.1, 0.05, 0.3);
    const SyntheticReadback before = Render(scene, first, {light});
    const SyntheticReadback after = Render(scene, second, {light});
    constexpr MapSize kFitted = {500, 400};
    const absl::StatusOr<LightMatrix> fit_before = FitLight(before.View(), light, kFitted, {});
    const absl::StatusOr<LightMatrix> fit_after = FitLight(after.View(), light, kFitted, {});
    if (!fit_before.ok() || !fit_after.ok()) continue;  // no shadow in view
    ++num_scenes;
    const Crawl crawl = Measured({before.View(), fit_before->map_from_world, kFitted},
                                 {after.View(), fit_after->map_from_world, kFitted},
                                 light);
    // What the second camera sees of a point is what a camera of one pixel around it sees.
    int64_t num_points = 0, num_moved = 0;
    double sum = 0.0;
    const Eigen::Matrix4d world_from_screen = first.WorldFromScreen();
    for (int y = 0; y < first.height; ++y) {
      for (int x = 0; x < first.width; ++x) {
        const float z = before.depth[static_cast<size_t>(y) * first.width + x];
        if (!(z < kSyntheticBackground)) continue;
        const Eigen::Vector4d screen(x + 0.5, y + 0.5, 1.0 / z, 1.0);
        const Eigen::Vector4d position = (world_from_screen * screen).hnormalized().homogeneous();
        const Eigen::Vector4d at = second.ScreenFromWorld() * position;
        const Eigen::Vector2d there = at.head<2>() / at.w();
        if (!(at.w() > 0.0) ||
            !(there.minCoeff() >= 0.0 && there.x() < second.width && there.y() < second.height)) {
          continue;
        }
        Camera pixel = second;
        pixel.width = pixel.height = 1;
        pixel.screen_from_camera.topRightCorner<2, 1>() += Eigen::Vector2d(0.5, 0.5) - there;
        const float seen_z = Render(scene, pixel, {}).depth[0];
        if (std::abs(at.w() / at.z() - seen_z) > 1e-3 * seen_z) continue;
        const Eigen::Vector4d from = fit_before->map_from_world * position;
        const Eigen::Vector4d to = fit_after->map_from_world * position;
        bool inside = from.w() > 0.0 && to.w() > 0.0;
        double squared = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
          const double a = from[axis] / from.w(), b = to[axis] / to.w();
          const double size = axis == 0 ? kFitted.width : kFitted.height;
          inside = inside && a >= 0.0 && a < size && b >= 0.0 && b < size;
          const double phase = std::abs((a - std::floor(a)) - (b - std::floor(b)));
          squared += std::min(phase, 1.0 - phase) * std::min(phase, 1.0 - phase);
        }
        if (!inside) continue;
        ++num_points;
        sum += squared;
        if (squared > kPhaseTolerance * kPhaseTolerance) ++num_moved;
      }
    }
    // At outlines the read-back alone cannot tell, and the image's outermost pixels have no slope.
    EXPECT_LE(crawl.num_points, num_points * 1.02) << seed;
    EXPECT_GE(crawl.num_points, num_points * 0.85) << seed;
    const double drift = std::sqrt(sum / static_cast<double>(num_points));
    worst = std::max(worst, std::abs(crawl.phase_drift_texels - drift));
    EXPECT_NEAR(crawl.moved_share, static_cast<double>(num_moved) / num_points, kStatistical);
    EXPECT_GT(crawl.num_edge_points, 0);
    EXPECT_GT(crawl.edge_crawl_px, 0.0);
  }
  std::printf("%d scenes, drift off by at most %.2g texels\n", num_scenes, worst);
  EXPECT_GE(num_scenes, 6);
  EXPECT_LE(worst, kStatistical);
}

// Steep slopes are no reason to lose a surface, whatever the kind of depth.
TEST(MeasureCrawl, SeesAPlaneAtAnySlope) {
  for (const DepthKind kind :
       {DepthKind::kCameraZ, DepthKind::kDistance, DepthKind::kNdcReversedZeroToOne}) {
    for (const double height : {10.0, 1.0, 0.1}) {  // at a distance of 3
      const auto camera_at = [&](double step) {
        Camera camera = *LookAtCamera(
            {0.0, -3.0 + step, height}, {0.0, step, -0.1 * height}, {0.0, 0.0, 1.0}, 0.02, 60, 40);
        camera.near = 0.5;
        camera.far = 50.0;
        return camera;
      };
      const PlaneReadback before(camera_at(0.0), kind, Eigen::Vector3d::UnitZ(), 0.0);
      const PlaneReadback after(camera_at(0.001), kind, Eigen::Vector3d::UnitZ(), 0.0);
      const Crawl crawl =
          Measured({before.View(), FloorMap(), kMap}, {after.View(), FloorMap(), kMap});
      EXPECT_GE(crawl.num_points, 56 * 36) << DepthKindName(kind) << ", height " << height;
    }
  }
}

TEST(MeasureCrawl, LeavesOutWhatMovedOrIsHidden) {
  const PlaneReadback floor = FloorReadback();
  PlaneReadback thing = FloorReadback();
  const auto is_thing = [](int x, int y) { return x >= 10 && x < 20 && y >= 5 && y < 12; };
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (is_thing(x, y)) thing.depth[thing.Index(x, y)] *= 0.95f;
    }
  }
  const auto num_points = [](const PlaneReadback& before, const PlaneReadback& after) {
    return Measured({before.View(), FloorMap(), kMap}, {after.View(), FloorMap(), kMap}).num_points;
  };
  constexpr int64_t kInner = 38 * 28;
  EXPECT_EQ(num_points(floor, floor), kInner);
  EXPECT_EQ(num_points(thing, thing), kInner);
  EXPECT_EQ(num_points(thing, floor), kInner - 10 * 7);  // it went away
  EXPECT_EQ(num_points(floor, thing), kInner - 10 * 7);  // it came
}

TEST(MeasureCrawl, LeavesOutWhatIsOutsideOrBehindTheMap) {
  const PlaneReadback floor = ShadowedFloor(FloorCamera(), 20);
  const auto count =
      [&floor](const Eigen::Matrix4d& before, const Eigen::Matrix4d& after, MapSize size) {
        const Crawl crawl = Measured({floor.View(), before, size}, {floor.View(), after, size});
        EXPECT_TRUE(std::isfinite(crawl.phase_drift_texels) && std::isfinite(crawl.edge_crawl_px));
        return std::pair(crawl.num_points, crawl.num_edge_points);
      };
  const Eigen::Matrix4d map = FloorMap();
  const auto all = count(map, map, kMap);
  const auto half = count(map, map, {1000, 2000});  // the middle of the floor is in its middle
  EXPECT_GT(half.first, 0.3 * all.first);
  EXPECT_LT(half.first, 0.7 * all.first);
  EXPECT_EQ(count(Shifted(map, {3000.0, 0.0}), map, kMap), std::pair(int64_t{0}, int64_t{0}));
  EXPECT_EQ(count(map, Shifted(map, {0.0, -3000.0}), kMap), std::pair(int64_t{0}, int64_t{0}));
  EXPECT_EQ(count(map, -map, kMap), std::pair(int64_t{0}, int64_t{0}));
}

}  // namespace
}  // namespace lightfit
