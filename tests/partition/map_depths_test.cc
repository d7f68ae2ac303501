#include "partition/map_depths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "partition/fit_plan.h"
#include "partition/pixel_rays.h"
#include "partition/tracking/kept_map.h"
#include "tests/partition/plan_case.h"
#include "tests/partition/receivers.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::CountUnserved;
using testing::IsOk;
using testing::PlanCase;
using testing::Unserved;

PlanOptions OptionsOf(Cover cover) {
  PlanOptions options;
  options.max_maps = 4;
  options.texels = 200 * 200;
  options.choose_by_forecast = false;
  options.fit.cover = cover;
  return options;
}

TEST(MapDepths, RowsOfPlansHaveAllThatAsksTheMaps) {
  int num_needed = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      for (const Cover cover : {Cover::kShadowed, Cover::kReceivers}) {
        const PlanOptions options = OptionsOf(cover);
        const PlanCase at(seed, index, Border::kLit, options.fit);
        const auto plan = FitPlan(at.surfaces, at.light, options);
        ASSERT_THAT(plan, IsOk());
        const Unserved unserved = CountUnserved(at.surfaces, at.light, PlanOf(*plan), cover);
        EXPECT_EQ(unserved.in_front, 0) << at.light.name << " seed " << seed;
        EXPECT_EQ(unserved.beyond, 0) << at.light.name << " seed " << seed;
        num_needed += unserved.num_needed;
      }
    }
  }
  EXPECT_GT(num_needed, 50'000);
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
    EXPECT_GT(CountUnserved(at.surfaces, at.light, plan, cover).in_front, 0);
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
    const Unserved unserved = CountUnserved(at.surfaces, at.light, plan, cover);
    EXPECT_EQ(unserved.in_front, 0) << at.light.name;
    EXPECT_EQ(unserved.beyond, 0) << at.light.name;
  }
  EXPECT_GT(num_spoilt, 5);
}

}  // namespace
}  // namespace lightfit
