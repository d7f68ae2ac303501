// tests/partition/tracking/tracked_plan.h
//
// What is so of every plan that a PlanTracker keeps, for tests of it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <string>

#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"
#include "partition/tracking/kept_map.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/partition/receivers.h"

namespace lightfit::testing {

inline constexpr int64_t kTexels = int64_t{200} * 200;
inline constexpr double kStep = 0.2;  // metres a frame: some pixels of the images here

inline PlanTrackerOptions OptionsOf(int max_maps, double stability) {
  PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
  options.plan.max_maps = max_maps;
  options.plan.texels = kTexels;
  options.plan.choose_by_forecast = false;
  return options;
}

inline std::string Where(uint64_t seed, const Light& light, size_t frame) {
  return "seed " + std::to_string(seed) + ", " + light.name + ", frame " + std::to_string(frame);
}

// That a tracked plan says of itself what is so.
inline void ExpectConsistent(const TrackedPlan& tracked, const PlanTrackerOptions& options) {
  const size_t num_maps = tracked.plan.maps.size();
  ASSERT_EQ(tracked.actions.size(), num_maps);
  ASSERT_EQ(tracked.frames_kept.size(), num_maps);
  EXPECT_GE(num_maps, 1u);
  EXPECT_LE(num_maps, static_cast<size_t>(options.plan.max_maps));
  EXPECT_LE(NumTexels(PlanOf(tracked.plan)), options.plan.texels);
  double energy = 0.0;
  int num_redrawn = 0;
  for (size_t k = 0; k < num_maps; ++k) {
    energy += tracked.plan.maps[k].figures.energy;
    EXPECT_TRUE(tracked.plan.maps[k].map_from_world.allFinite());
    EXPECT_EQ(tracked.frames_kept[k] == 0, IsRedrawn(tracked.actions[k]));
    num_redrawn += IsRedrawn(tracked.actions[k]) ? 1 : 0;
  }
  EXPECT_EQ(tracked.NumRedrawn(), num_redrawn);
  EXPECT_NEAR(tracked.plan.energy, energy, 1e-9 * energy);
  EXPECT_TRUE(std::isfinite(tracked.best_energy));
}

// That its maps hold all that must be held.
inline void ExpectHeld(const TrackedPlan& tracked,
                       const Surfaces& surfaces,
                       const Light& light,
                       const PlanTrackerOptions& options) {
  const Unserved unserved = CountUnserved(
      surfaces, light, PlanOf(tracked.plan), options.plan.fit.cover, options.plan.guard_texels);
  EXPECT_EQ(unserved.outside, 0);
  EXPECT_EQ(unserved.in_front, 0);
  EXPECT_EQ(unserved.beyond, 0);
  EXPECT_GT(unserved.num_needed, 0);
}

// That what was done to the maps is what the actions say. Rows 0, 1 and 3 are the texels.
inline void ExpectActions(const TrackedPlanState& before, const TrackedPlan& tracked) {
  if (tracked.is_new) {
    EXPECT_EQ(tracked.NumRedrawn(), static_cast<int>(tracked.plan.maps.size()));
    return;
  }
  ASSERT_EQ(tracked.plan.maps.size(), before.maps.size());
  EXPECT_EQ(tracked.plan.border, before.border);
  for (size_t k = 0; k < before.maps.size(); ++k) {
    const Eigen::Matrix4d& now = tracked.plan.maps[k].map_from_world;
    const Eigen::Matrix4d& then = before.maps[k].map_from_world;
    EXPECT_EQ(tracked.plan.maps[k].map.width, before.maps[k].size.width);
    EXPECT_EQ(tracked.plan.maps[k].map.height, before.maps[k].size.height);
    if (IsRedrawn(tracked.actions[k])) continue;
    EXPECT_EQ(tracked.frames_kept[k], before.maps[k].frames_kept + 1);
    EXPECT_EQ(now.row(3), then.row(3));
    for (const int row : {0, 1}) {
      if (tracked.actions[k] == TrackerAction::kKept) {
        EXPECT_EQ(now.row(row), then.row(row));
        continue;
      }
      ASSERT_EQ(tracked.actions[k], TrackerAction::kShifted);
      const Eigen::RowVector4d moved = now.row(row) - then.row(row);
      const double texels = std::round(moved.dot(then.row(3)) / then.row(3).squaredNorm());
      EXPECT_LT((moved - texels * then.row(3)).norm(), 1e-9 * now.row(row).norm());
    }
  }
}

inline void ExpectSameState(const TrackedPlanState& a, const TrackedPlanState& b) {
  EXPECT_EQ(a.frames_since_update, b.frames_since_update);
  EXPECT_EQ(a.border, b.border);
  ASSERT_EQ(a.maps.size(), b.maps.size());
  for (size_t k = 0; k < a.maps.size(); ++k) {
    EXPECT_EQ(a.maps[k].map_from_world, b.maps[k].map_from_world);
    EXPECT_EQ(a.maps[k].frames_kept, b.maps[k].frames_kept);
  }
}

}  // namespace lightfit::testing
