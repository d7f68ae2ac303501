#include "partition/tracking/plan_crawl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "geometry/affine_depth.h"
#include "tests/optimizer/figures/floor_crawl.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::FloorMap;
using testing::FloorReadback;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::kMap;
using testing::kSun;
using testing::PlaneReadback;
using testing::Random;
using testing::ShadowedFloor;
using testing::Shifted;
using testing::StatusIs;
using testing::Stepped;

// What maps of 2000 texels round by, in texels.
constexpr double kRounding = 1e-9;

const Eigen::RowVector4d kNowhere(0.0, 0.0, 0.0, -1.0);

PlanMap MapOf(const Eigen::Matrix4d& map_from_world, MapSize size = kMap) {
  return {map_from_world, size, {}};
}

Plan PlanOfMaps(std::vector<PlanMap> maps) {
  Plan plan;
  plan.light_name = kSun.name;
  plan.maps.assign(maps.begin(), maps.end());
  return plan;
}

// A part of the floor's map, from a column on, in texels of `scale` times the size.
PlanMap PartOf(int first_column, int num_columns, double scale) {
  Eigen::Matrix4d map_from_world = Shifted(FloorMap(), {-first_column, 0.0});
  map_from_world.topRows<2>() /= scale;
  return MapOf(map_from_world,
               {static_cast<int>(num_columns / scale), static_cast<int>(kMap.height / scale)});
}

// The left half of the floor in fine texels, all of it in coarse ones.
Plan TwoMaps() { return PlanOfMaps({PartOf(0, 1000, 1.0), PartOf(0, 2000, 3.0)}); }

Crawl Measured(const PlaneReadback& before,
               const Plan& plan_before,
               const PlaneReadback& after,
               const Plan& plan_after) {
  const absl::StatusOr<Crawl> crawl =
      MeasurePlanCrawl({before.View(), plan_before}, {after.View(), plan_after}, kSun);
  EXPECT_THAT(crawl, IsOk());
  return crawl.ok() ? *crawl : Crawl();
}

TEST(MeasurePlanCrawl, OfOneMapIsThatOfTheMap) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 18);
  Random random(5);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Matrix4d moved =
        Shifted(FloorMap(), {random.Uniform(-3.0, 3.0), random.Uniform(-3.0, 3.0)});
    const Crawl one =
        testing::Measured({before.View(), FloorMap(), kMap}, {after.View(), moved, kMap});
    const Crawl plan =
        Measured(before, PlanOfMaps({MapOf(FloorMap())}), after, PlanOfMaps({MapOf(moved)}));
    EXPECT_EQ(plan.num_points, one.num_points);
    EXPECT_EQ(plan.num_edge_points, one.num_edge_points);
    EXPECT_EQ(plan.moved_share, one.moved_share);
    EXPECT_NEAR(plan.phase_drift_texels, one.phase_drift_texels, kRounding);
    EXPECT_NEAR(plan.edge_crawl_px, one.edge_crawl_px, kRounding);
    EXPECT_GT(plan.num_edge_points, 20);
  }
}

TEST(MeasurePlanCrawl, IsNothingForMapsThatAreKeptOrMovedByWholeTexels) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 18);
  const Plan plan = TwoMaps();
  const Crawl kept = Measured(before, plan, after, plan);
  EXPECT_GT(kept.num_points, 500);
  EXPECT_EQ(kept.phase_drift_texels, 0.0);
  EXPECT_EQ(kept.moved_share, 0.0);
  EXPECT_EQ(kept.edge_crawl_px, 0.0);

  Plan shifted = plan;
  shifted.maps[1].map_from_world = Shifted(plan.maps[1].map_from_world, {-4.0, 7.0});
  const Crawl moved = Measured(before, plan, after, shifted);
  EXPECT_LT(moved.phase_drift_texels, kRounding);
  EXPECT_EQ(moved.moved_share, 0.0);
}

// The same once more pixel by pixel, from the definition: the densest map by the determinant of its
// Jacobian, found by differences.
TEST(MeasurePlanCrawl, FollowsEachPointInTheMapThatItAsks) {
  const PlaneReadback before = ShadowedFloor(FloorCamera(), 20);
  const PlaneReadback after = ShadowedFloor(Stepped(), 18);
  struct Place {
    int map;
    Eigen::Vector2d texel;
  };
  const auto look_up = [](const Plan& plan, const Eigen::Vector3d& world) {
    std::optional<Place> densest;
    double most = 0.0;
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      const auto texel_of = [&](const Eigen::Vector3d& at) -> Eigen::Vector2d {
        const Eigen::Vector4d map = plan.maps[k].map_from_world * at.homogeneous();
        return map.head<2>() / map.w();
      };
      const Eigen::Vector2d texel = texel_of(world);
      if ((texel.array() < 0.0).any() || texel.x() >= plan.maps[k].size.width ||
          texel.y() >= plan.maps[k].size.height) {
        continue;
      }
      constexpr double kStep = 1e-4;  // metres
      Eigen::Matrix2d J;
      J.col(0) = texel_of(world + kStep * Eigen::Vector3d::UnitX()) - texel;
      J.col(1) = texel_of(world + kStep * Eigen::Vector3d::UnitY()) - texel;
      const double density = std::abs(J.determinant());
      if (density <= most) continue;
      most = density;
      densest = {static_cast<int>(k), texel};
    }
    return densest;
  };
  const Plan plan = TwoMaps();
  Random random(6);
  int num_moved_in_all = 0, num_of_other_in_all = 0;
  for (int i = 0; i < 5; ++i) {
    // Of two maps one is redrawn, or both, or their common border moves.
    Plan changed = plan;
    for (PlanMap& map : changed.maps) {
      if (random.Coin()) continue;
      map.map_from_world =
          Shifted(map.map_from_world, {random.Uniform(-30.0, 30.0), random.Uniform(-30.0, 30.0)});
    }
    const AffineDepth affine_depth(before.camera, before.kind);
    int num_points = 0, num_moved = 0, num_of_other = 0;
    double sum = 0.0;
    for (int y = 0; y < before.camera.height; ++y) {
      for (int x = 0; x < before.camera.width; ++x) {
        const double d = affine_depth.At(x, y, before.depth[before.Index(x, y)]);
        const Eigen::Vector4d world =
            before.camera.WorldFromScreen() * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
        const Eigen::Vector3d position = world.hnormalized();
        const Eigen::Vector3d seen =
            (after.camera.ScreenFromWorld() * position.homogeneous()).hnormalized();
        // As Crawl's points: with differences of depth there.
        const bool is_inner = seen.x() >= 1.0 && seen.x() < after.camera.width - 1 &&
                              seen.y() >= 1.0 && seen.y() < after.camera.height - 1;
        if (!is_inner) continue;
        const auto from = look_up(plan, position), to = look_up(changed, position);
        if (!from.has_value() || !to.has_value()) continue;
        Eigen::Vector2d change = to->texel - from->texel;
        change -= change.array().round().matrix();
        ++num_points;
        sum += change.squaredNorm();
        num_of_other += from->map != to->map ? 1 : 0;
        num_moved += from->map != to->map || change.norm() > kPhaseTolerance ? 1 : 0;
      }
    }
    const Crawl crawl = Measured(before, plan, after, changed);
    std::printf("%d points, %d moved, %d ask another map\n", num_points, num_moved, num_of_other);
    ASSERT_GT(num_points, 500);
    num_of_other_in_all += num_of_other;
    num_moved_in_all += num_moved;
    EXPECT_EQ(crawl.num_points, num_points);
    EXPECT_NEAR(crawl.moved_share * num_points, num_moved, 1e-6);
    EXPECT_NEAR(crawl.phase_drift_texels, std::sqrt(sum / num_points), kRounding);
  }
  EXPECT_GT(num_moved_in_all, 1000);
  EXPECT_GT(num_of_other_in_all, 10);
}

TEST(MeasurePlanCrawl, CountsPointsThatAskAnotherMapAsRedrawn) {
  const PlaneReadback floor = ShadowedFloor(FloorCamera(), 20);
  // The same map twice, one of which serves nobody.
  Plan first = PlanOfMaps({MapOf(FloorMap()), MapOf(FloorMap())}), second = first;
  first.maps[1].half_spaces.push_back(kNowhere);
  second.maps[0].half_spaces.push_back(kNowhere);
  const Crawl crawl = Measured(floor, first, floor, second);
  EXPECT_GT(crawl.num_points, 1000);
  EXPECT_EQ(crawl.moved_share, 1.0);
  EXPECT_EQ(crawl.phase_drift_texels, 0.0);
}

TEST(MeasurePlanCrawl, LeavesOutWhatNoMapMayBeAskedAbout) {
  const PlaneReadback floor = ShadowedFloor(FloorCamera(), 20);
  Plan nobody = PlanOfMaps({MapOf(FloorMap())});
  nobody.maps[0].half_spaces.push_back(kNowhere);
  const Plan all = PlanOfMaps({MapOf(FloorMap())});
  EXPECT_EQ(Measured(floor, nobody, floor, all).num_points, 0);
  EXPECT_EQ(Measured(floor, all, floor, nobody).num_points, 0);
  // A guard that leaves little.
  const auto guarded = MeasurePlanCrawl({floor.View(), all}, {floor.View(), all}, kSun, 800.0);
  ASSERT_THAT(guarded, IsOk());
  EXPECT_LT(guarded->num_points, Measured(floor, all, floor, all).num_points);
}

TEST(MeasurePlanCrawl, NamesWhatCannotBeUsed) {
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  const PlaneReadback floor = FloorReadback();
  const Plan good = PlanOfMaps({MapOf(FloorMap())});
  const PlannedFrame frame = {floor.View(), good};
  Plan bad = good;
  bad.maps[0].map_from_world(1, 2) = std::nan("");
  EXPECT_THAT(MeasurePlanCrawl({floor.View(), bad}, frame, kSun),
              StatusIs(kInvalid, HasSubstr("before: light \"sun\": map_from_world is not finite")));
  EXPECT_THAT(MeasurePlanCrawl(frame, {floor.View(), PlanOfMaps({})}, kSun),
              StatusIs(kInvalid, HasSubstr("after: light \"sun\": a plan of 0 maps")));
  Readback cut = floor.View();
  cut.depth = cut.depth.subspan(1);
  EXPECT_THAT(MeasurePlanCrawl(frame, {cut, good}, kSun),
              StatusIs(kInvalid, HasSubstr("after: readback.depth")));
  SampleOptions options;
  options.edge_window = 99;
  EXPECT_THAT(MeasurePlanCrawl(frame, frame, kSun, 0.0, options),
              StatusIs(kInvalid, HasSubstr("samples.edge_window")));
  EXPECT_THAT(MeasurePlanCrawl(frame, frame, Light::Directional("sun", {0, 0, 0})),
              StatusIs(kInvalid, HasSubstr("light \"sun\": direction")));
  EXPECT_THAT(MeasurePlanCrawl(frame, frame, kSun, 1e4),
              StatusIs(kInvalid, HasSubstr("2000x2000")));
}

}  // namespace
}  // namespace lightfit
