#include "optimizer/figures/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "tests/optimizer/figures/floor_crawl.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::FloorMap;
using testing::FloorReadback;
using ::testing::HasSubstr;
using testing::kMap;
using testing::kSun;
using testing::Measured;
using testing::PlaneReadback;
using testing::Random;
using testing::ShadowedFloor;
using testing::Shifted;
using testing::StatusIs;
using testing::Stepped;

// 1 / sqrt 6: two coordinates, each uniform over a texel.
const double kUnrelated = std::sqrt(1.0 / 6.0);

// Rounding of (u, v) of some thousands of texels in double precision, texels.
constexpr double kRounding = 1e-9;

// The root mean square over the thousands of points of a frame is good to some 1 %.
constexpr double kStatistical = 0.02;

TEST(MeasureCrawl, IsNothingForAMatrixThatIsKept) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 19);
  const Crawl crawl = Measured({before.View(), FloorMap(), kMap}, {after.View(), FloorMap(), kMap});
  EXPECT_GT(crawl.num_points, 900);
  EXPECT_EQ(crawl.num_edge_points, 2 * 28);
  EXPECT_EQ(crawl.phase_drift_texels, 0.0);
  EXPECT_EQ(crawl.moved_share, 0.0);
  EXPECT_EQ(crawl.edge_crawl_px, 0.0);
}

TEST(MeasureCrawl, IsRoundingForMovesByWholeTexels) {
  Random random(411);
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 19);
  double worst = 0.0;
  for (int i = 0; i < 50; ++i) {
    const Light light =
        i % 2 == 0
            ? Light::Directional("sun", random.UnitVector() - Eigen::Vector3d(0, 0, 3))
            : Light::Point(
                  "lamp",
                  {random.Uniform(-9, 9), random.Uniform(-9, 9), random.LogUniform(10, 1000)});
    const Eigen::Matrix<double, 3, 4> ray_from_world =
        RayFromWorld(light, -Eigen::Vector3d::UnitZ());
    Eigen::Matrix3d map_from_ray = Eigen::Matrix3d::Identity();
    map_from_ray.topLeftCorner<2, 2>() = random.LogUniform(100, 2000) * random.Matrix2(5.0);
    map_from_ray.topRightCorner<2, 1>().setConstant(1000.0);
    map_from_ray.row(2).head<2>() =
        Eigen::RowVector2d(random.Uniform(-0.05, 0.05), random.Uniform(-0.05, 0.05));
    const Eigen::Matrix<double, 3, 4> rows = map_from_ray * ray_from_world;
    Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Zero();
    map_from_world << rows.topRows<2>(), Eigen::RowVector4d::Zero(), rows.row(2);
    // The origin in the middle of the map.
    map_from_world = Shifted(
        map_from_world,
        Eigen::Vector2d(1000.0, 1000.0) - map_from_world.col(3).head<2>() / map_from_world(3, 3));
    const Eigen::Vector2d whole(random.Int(-300, 300), random.Int(-300, 300));
    // The matrix as a whole may have any scale.
    const Eigen::Matrix4d moved = random.LogUniform(0.01, 100) * Shifted(map_from_world, whole);
    const Crawl crawl = Measured(
        {before.View(), map_from_world, {2000, 2000}}, {after.View(), moved, {2000, 2000}}, light);
    ASSERT_GT(crawl.num_points, 0) << i;
    EXPECT_EQ(crawl.moved_share, 0.0) << i;
    EXPECT_LE(crawl.edge_crawl_px, kRounding) << i;
    worst = std::max(worst, crawl.phase_drift_texels);
  }
  std::printf("phase drift at most %.2g texels\n", worst);
  EXPECT_LE(worst, kRounding);
}

TEST(MeasureCrawl, IsThatOfChanceForUnrelatedMatrices) {
  const PlaneReadback before = FloorReadback(FloorCamera(120, 90));
  const PlaneReadback after = FloorReadback(Stepped(120, 90));
  // Turned by a radian around the middle of the map, and finer.
  const Eigen::Vector3d middle(1000.0, 1000.0, 1.0);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = 1.3 * Eigen::Rotation2Dd(1.0).toRotationMatrix();
  turn.topRightCorner<2, 1>() = middle.head<2>() - turn.topLeftCorner<2, 2>() * middle.head<2>();
  Eigen::Matrix4d turned = FloorMap();
  turned.topRows<2>() = turn.topLeftCorner<2, 2>() * FloorMap().topRows<2>() +
                        turn.topRightCorner<2, 1>() * FloorMap().row(3);
  const Crawl crawl = Measured({before.View(), FloorMap(), kMap}, {after.View(), turned, kMap});
  EXPECT_GT(crawl.num_points, 5000);
  EXPECT_NEAR(crawl.phase_drift_texels, kUnrelated, kStatistical * kUnrelated);
  // All but a disc of the texel's area.
  EXPECT_NEAR(crawl.moved_share, 1.0 - M_PI * kPhaseTolerance * kPhaseTolerance, 1e-3);
}

TEST(MeasureCrawl, GrowsWithASmallMoveAndIsTheShorterWayAround) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 19);
  const Eigen::Vector2d direction = Eigen::Vector2d(0.6, -0.8);
  const auto crawl_of = [&](const Eigen::Vector2d& texels) {
    return Measured({before.View(), FloorMap(), kMap},
                    {after.View(), Shifted(FloorMap(), texels), kMap});
  };
  const Crawl unit = crawl_of(0.001 * direction);
  EXPECT_NEAR(unit.phase_drift_texels, 0.001, kRounding);
  EXPECT_EQ(unit.moved_share, 0.0);
  for (const double texels : {0.002, 0.05, 0.4}) {
    const Crawl crawl = crawl_of(texels * direction);
    EXPECT_NEAR(crawl.phase_drift_texels, texels, kRounding);
    EXPECT_NEAR(crawl.edge_crawl_px, texels / 0.001 * unit.edge_crawl_px, 1e-6);
    EXPECT_EQ(crawl.moved_share, texels > kPhaseTolerance ? 1.0 : 0.0);
  }
  EXPECT_NEAR(crawl_of({0.7, -5.0}).phase_drift_texels, 0.3, kRounding);
  EXPECT_NEAR(crawl_of({0.5, 12.5}).phase_drift_texels, std::sqrt(0.5), kRounding);
}

// On the plane the map's texel positions are found again on the screen by the inverse homography.
TEST(MeasureCrawl, EdgeCrawlIsHowFarTexelsMoveAcrossTheEdge) {
  const Camera camera = FloorCamera();
  const PlaneReadback readback = ShadowedFloor(camera, 20);
  const Eigen::Vector2d shift(0.01, 0.02);
  const Eigen::Matrix4d moved = Shifted(FloorMap(), shift);
  const Crawl crawl = Measured({readback.View(), FloorMap(), kMap}, {readback.View(), moved, kMap});

  Eigen::Matrix<double, 4, 3> floor = Eigen::Matrix<double, 4, 3>::Zero();  // of (x, y, 1)
  floor(0, 0) = floor(1, 1) = floor(3, 2) = 1.0;
  const auto without_depth = [](const Eigen::Matrix4d& m) {
    Eigen::Matrix<double, 3, 4> rows;
    rows << m.topRows<2>(), m.row(3);
    return rows;
  };
  const Eigen::Matrix3d map_from_floor = without_depth(moved) * floor;
  const Eigen::Matrix3d screen_from_floor = without_depth(camera.ScreenFromWorld()) * floor;
  const Eigen::Matrix3d screen_from_map = screen_from_floor * map_from_floor.inverse();
  double sum = 0.0;
  for (int y = 1; y < camera.height - 1; ++y) {
    for (const int x : {19, 20}) {
      const Eigen::Vector2d centre(x + 0.5, y + 0.5);
      const Eigen::Vector2d texel =
          (screen_from_map.inverse() * centre.homogeneous()).hnormalized();
      const Eigen::Vector2d there =
          (screen_from_map * Eigen::Vector2d(texel + shift).homogeneous()).hnormalized();
      sum += (there - centre).x() * (there - centre).x();
    }
  }
  EXPECT_EQ(crawl.num_edge_points, 2 * 28);
  // First order in the shift; the slopes of a float depth.
  EXPECT_NEAR(crawl.edge_crawl_px, std::sqrt(sum / (2 * 28)), 2e-3 * crawl.edge_crawl_px);
  EXPECT_GT(crawl.edge_crawl_px, 0.0);
}

TEST(MeasureCrawl, TakesPartOfALargeImage) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(1000, 800), 500);
  const PlaneReadback after = ShadowedFloor(Stepped(1000, 800), 490);
  const Eigen::Matrix4d moved = Shifted(FloorMap(), {0.1, 0.2});
  const Crawl crawl = Measured({before.View(), FloorMap(), kMap}, {after.View(), moved, kMap});
  EXPECT_GT(crawl.num_points, 5000);
  EXPECT_LT(crawl.num_points, 20000);
  EXPECT_NEAR(crawl.phase_drift_texels, std::hypot(0.1, 0.2), kRounding);
}

TEST(MeasureCrawl, IsNothingWhereNothingIsSeen) {
  const PlaneReadback floor = FloorReadback();
  PlaneReadback empty = floor;
  empty.depth.assign(empty.depth.size(), 1e10f);
  using Frames = std::pair<const PlaneReadback&, const PlaneReadback&>;
  for (const auto& [before, after] :
       {Frames(empty, floor), Frames(floor, empty), Frames(empty, empty)}) {
    const Crawl crawl =
        Measured({before.View(), FloorMap(), kMap}, {after.View(), FloorMap(), kMap});
    EXPECT_EQ(crawl.num_points, 0);
    EXPECT_EQ(crawl.num_edge_points, 0);
    EXPECT_EQ(crawl.phase_drift_texels, 0.0);
  }
  // No shadow: no edge.
  EXPECT_EQ(
      Measured({floor.View(), FloorMap(), kMap}, {floor.View(), FloorMap(), kMap}).num_edge_points,
      0);
}

TEST(MeasureCrawl, NamesWhatCannotBeUsed) {
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  const PlaneReadback floor = FloorReadback();
  const MappedFrame good = {floor.View(), FloorMap(), kMap};
  MappedFrame bad = good;
  bad.map_from_world(1, 2) = std::nan("");
  EXPECT_THAT(MeasureCrawl(bad, good, kSun),
              StatusIs(kInvalid, HasSubstr("before.map_from_world")));
  bad = good;
  bad.map.width = 0;
  EXPECT_THAT(MeasureCrawl(good, bad, kSun), StatusIs(kInvalid, HasSubstr("after.map = 0x2000")));
  bad = good;
  bad.readback.depth = bad.readback.depth.subspan(1);
  EXPECT_THAT(MeasureCrawl(good, bad, kSun),
              StatusIs(kInvalid, HasSubstr("after: readback.depth")));
  EXPECT_THAT(MeasureCrawl(good, good, Light::Directional("sun", {0, 0, 0})),
              StatusIs(kInvalid, HasSubstr("light \"sun\": direction")));
  SampleOptions options;
  options.edge_window = 99;
  EXPECT_THAT(MeasureCrawl(good, good, kSun, options),
              StatusIs(kInvalid, HasSubstr("samples.edge_window")));
}

}  // namespace
}  // namespace lightfit
