#include "partition/map_depths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>

#include "optimizer/readback/needed_surfaces.h"
#include "partition/fit_plan.h"
#include "partition/pixel_rays.h"
#include "partition/tracking/kept_map.h"
#include "tests/partition/plan_case.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ForEachReceiver;
using testing::IsOk;
using testing::PlanCase;

constexpr double kRounding = 1e-9;

PlanOptions OptionsOf(Cover cover) {
  PlanOptions options;
  options.max_maps = 4;
  options.texels = 200 * 200;
  options.choose_by_forecast = false;
  options.fit.cover = cover;
  return options;
}

// What lies outside of 0 ... 1 in the map that it asks: what must be served, and what is further
// than all.
struct OutOfDepth {
  int served = 0, beyond = 0;
};
OutOfDepth Count(const PlanCase& at, const Plan& plan, Cover cover) {
  OutOfDepth count;
  const auto look_up = PlanLookUp::Create(plan, at.light);
  EXPECT_THAT(look_up, IsOk());
  const NeededSurfaces needed(at.surfaces, at.light, plan.border);
  const auto depth_at = [&](const Eigen::Vector3d& world) -> double {
    const int k = look_up->At(world).map;
    if (k < 0) return 0.5;
    const Eigen::Vector4d map = plan.maps[k].map_from_world * world.homogeneous();
    return map.z() / map.w();
  };
  const absl::Span<const uint32_t> all;
  ForEachReceiver(
      at.surfaces,
      cover == Cover::kReceivers ? all : needed.words(),
      uint32_t{1} << at.light.shadow_bit,
      [&](const Eigen::Vector3d& world) { count.served += depth_at(world) < -kRounding ? 1 : 0; });
  ForEachReceiver(at.surfaces, all, 0, [&](const Eigen::Vector3d& world) {
    count.beyond += depth_at(world) > 1.0 + kRounding ? 1 : 0;
  });
  return count;
}

TEST(MapDepths, RowsOfPlansHaveAllThatAsksTheMaps) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      for (const Cover cover : {Cover::kShadowed, Cover::kReceivers}) {
        const PlanOptions options = OptionsOf(cover);
        const PlanCase at(seed, index, Border::kLit, options.fit);
        const auto plan = FitPlan(at.surfaces, at.light, options);
        ASSERT_THAT(plan, IsOk());
        const OutOfDepth count = Count(at, PlanOf(*plan), cover);
        EXPECT_EQ(count.served, 0) << at.light.name << " seed " << seed;
        EXPECT_EQ(count.beyond, 0) << at.light.name << " seed " << seed;
      }
    }
  }
}

TEST(MapDepths, SayWhetherARowFitsAndLayOneThatDoes) {
  int num_spoilt = 0;
  for (int index = 0; index < 3; ++index) {
    const Cover cover = Cover::kShadowed;
    const PlanCase at(2, index);
    const auto fitted = FitPlan(at.surfaces, at.light, OptionsOf(cover));
    ASSERT_THAT(fitted, IsOk());
    Plan plan = PlanOf(*fitted);
    ScratchVector<RayMap> maps;
    ScratchVector<Eigen::Matrix4d> matrices;
    for (PlanMap& map : plan.maps) {
      maps.push_back(
          MakeKeptMap(at.view, map.map_from_world, map.size, TrackerAction::kKept)->rays);
      matrices.push_back(map.map_from_world);
    }
    for (const MapDepths& depths : FindMapDepths(at.view, at.fit, maps, matrices, 0.0)) {
      EXPECT_TRUE(depths.Fits());
    }
    // Half the range, from its middle on.
    for (size_t k = 0; k < matrices.size(); ++k) {
      matrices[k].row(2) = 2.0 * matrices[k].row(2) - matrices[k].row(3);
      plan.maps[k].map_from_world = matrices[k];
    }
    const ScratchVector<MapDepths> spoilt = FindMapDepths(at.view, at.fit, maps, matrices, 0.0);
    EXPECT_GT(Count(at, plan, cover).served, 0);
    for (size_t k = 0; k < spoilt.size(); ++k) {
      if (!spoilt[k].IsAsked()) continue;
      num_spoilt += spoilt[k].Fits() ? 0 : 1;
      EXPECT_LE(spoilt[k].least_w, spoilt[k].least_w_served);
      EXPECT_LE(spoilt[k].least_w_served, spoilt[k].most_w);
      for (const double room : {0.0, 0.2}) {
        LayDepthRow(at.light,
                    spoilt[k],
                    DistancesFromLight(at.surfaces, at.light),
                    room,
                    &plan.maps[k].map_from_world);
        EXPECT_EQ(plan.maps[k].map_from_world.row(0), matrices[k].row(0));
        EXPECT_EQ(plan.maps[k].map_from_world.row(3), matrices[k].row(3));
      }
    }
    const OutOfDepth count = Count(at, plan, cover);
    EXPECT_EQ(count.served, 0) << at.light.name;
    EXPECT_EQ(count.beyond, 0) << at.light.name;
  }
  EXPECT_GT(num_spoilt, 5);
}

}  // namespace
}  // namespace lightfit
