#include "partition/tracking/keep_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "optimizer/energy/footprint.h"
#include "partition/fit_plan.h"
#include "tests/partition/plan_case.h"
#include "tests/partition/tracking/plan_walk.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HasShadows;
using testing::IsOk;
using testing::PlanCase;
using testing::Random;

PlanOptions OptionsOf(int max_maps) {
  PlanOptions options;
  options.max_maps = max_maps;
  options.texels = 200 * 200;
  options.choose_by_forecast = false;
  return options;
}

KeptMaps MapsOf(const LightView& view, const LightPlan& plan) {
  KeptMaps maps;
  for (const LightMatrix& map : plan.maps) {
    maps.push_back(*MakeKeptMap(view, map.map_from_world, map.map, TrackerAction::kKept));
  }
  return maps;
}

// All whole moves, one by one.
TEST(ShiftedToHold, FindsAMoveWhereThereIsOne) {
  const PlanCase at(1, 0);
  const KeptMap map = MapsOf(at.view, *FitPlan(at.surfaces, at.light, OptionsOf(1))).front();
  Random random(43);
  int num_kept = 0, num_moved = 0, num_too_large = 0;
  for (int i = 0; i < 200; ++i) {
    const double guard = random.Coin() ? 0.0 : random.Uniform(0.0, 3.0);
    ScratchVector<Eigen::Vector3d> rays;
    const double left = random.Uniform(-60.0, 150.0), top = random.Uniform(-60.0, 150.0);
    const double width = random.Uniform(1.0, map.size.width + 2.0);
    const double height = random.Uniform(1.0, map.size.height + 2.0);
    for (const double u : {left, left + width}) {
      for (const double v : {top, top + height}) {
        rays.push_back(map.rays.map_from_ray.inverse() * Eigen::Vector3d(u, v, 1.0));
      }
    }
    const auto interval_fits = [&](double low, double size, double side) {
      for (int shift = -400; shift <= 400; ++shift) {
        if (low + shift >= guard && low + size + shift <= side - guard) return true;
      }
      return false;
    };
    const bool fits =
        interval_fits(left, width, map.size.width) && interval_fits(top, height, map.size.height);
    const std::optional<KeptMap> moved = ShiftedToHold(map, rays, guard);
    ASSERT_EQ(moved.has_value(), fits) << i;
    if (!fits) {
      ++num_too_large;
      continue;
    }
    for (const Eigen::Vector3d& ray : rays) {
      EXPECT_TRUE(moved->rays.Holds(ray, guard - 2.0 * kHeldTolerance));
    }
    const bool is_kept = moved->action == TrackerAction::kKept;
    EXPECT_EQ(is_kept, moved->map_from_world == map.map_from_world);
    (is_kept ? num_kept : num_moved) += 1;
    for (const int row : {0, 1}) {
      const double texels = (moved->map_from_world.row(row) - map.map_from_world.row(row))
                                .dot(map.map_from_world.row(3)) /
                            map.map_from_world.row(3).squaredNorm();
      EXPECT_NEAR(texels, std::round(texels), 1e-6);
    }
    EXPECT_EQ(moved->map_from_world.row(3), map.map_from_world.row(3));
  }
  std::printf("%d kept, %d moved, %d too large\n", num_kept, num_moved, num_too_large);
  EXPECT_GT(num_kept, 5);
  EXPECT_GT(num_moved, 50);
  EXPECT_GT(num_too_large, 5);
}

// math.md (23), sample by sample, with footprints from their Jacobians.
TEST(FrameCosts, AreWhatTheyAreByDefinition) {
  constexpr double kGuard = 1.5;
  for (const Metric metric : {Metric::kL1AcrossEdge, Metric::kL1, Metric::kL2}) {
    for (int index = 0; index < 3; ++index) {
      FitOptions fit;
      fit.metric = metric;
      const PlanCase at(2, index, Border::kLit, fit);
      PlanOptions options = OptionsOf(3);
      options.fit.metric = metric;
      options.guard_texels = kGuard;
      const auto plan = FitPlan(at.surfaces, at.light, options);
      ASSERT_THAT(plan, IsOk());
      const KeptMaps before = MapsOf(at.view, *plan);
      const FrameCosts costs(at.view, at.rays, before, at.fit, kGuard);
      EXPECT_NEAR(costs.EnergyOf(before), plan->energy, 1e-9 * plan->energy);

      // One map redrawn, one moved out of the way of some of its receivers.
      KeptMaps maps = before;
      maps[0].action = TrackerAction::kInvalid;
      const Eigen::Matrix4d grown = [&] {
        Eigen::Matrix4d matrix = maps[1].map_from_world;
        matrix.row(0) += std::round(0.4 * maps[1].size.width) * matrix.row(3);
        return matrix;
      }();
      maps[1] = *MakeKeptMap(at.view, grown, maps[1].size, TrackerAction::kShifted);
      const auto asked = [](const KeptMaps& of, const Eigen::Vector3d& ray) {
        int densest = -1;
        double most = 0.0;
        for (size_t k = 0; k < of.size(); ++k) {
          const Eigen::Matrix3d& H = of[k].rays.map_from_ray;
          const Eigen::Vector3d map = H * ray;
          const double low = kGuard * map.z();
          if (!(map.z() > 0.0 && map.x() >= low && map.y() >= low &&
                map.x() < of[k].size.width * map.z() - low &&
                map.y() < of[k].size.height * map.z() - low)) {
            continue;
          }
          const double density = std::abs(H.determinant()) / std::pow(map.z(), 3);
          if (density > most) densest = static_cast<int>(k);
          most = std::max(most, density);
        }
        return densest;
      };
      const bool is_l1 = IsL1(metric);
      double energy = 0.0, squares = 0.0, weight = 0.0;
      for (const RaySample& sample : at.rays.samples) {
        const int k = asked(maps, sample.X);
        if (k < 0) continue;
        const Eigen::Matrix3d H = maps[k].rays.map_from_ray;
        Eigen::Matrix3d G;
        G << sample.G(0), sample.G(1), sample.G(2),  //
            sample.G(1), sample.G(3), sample.G(4),   //
            sample.G(2), sample.G(4), sample.G(5);
        const double w = H.row(2) * sample.X;
        const Eigen::Matrix<double, 3, 2> r = H.inverse().leftCols<2>();
        const double squared = w * w * (r.transpose() * G * r).trace();
        const double term = is_l1 ? std::sqrt(squared) : squared;
        energy += sample.weight * term;
        weight += sample.weight;
        if (k == 0 || asked(before, sample.X) != k) squares += sample.weight * squared;
      }
      const double redrawn = is_l1 ? std::sqrt(weight * squares) : squares;
      EXPECT_NEAR(costs.CostOf(maps), energy + redrawn, 1e-6 * (energy + redrawn));
      EXPECT_GT(redrawn, 0.0);
      const double most = 2.0 * costs.EnergyOf(maps);
      EXPECT_NEAR(costs.PriceOf(maps, most), redrawn / (0.5 * most), 1e-6 * redrawn / most);
      EXPECT_EQ(costs.PriceOf(maps, 0.5 * costs.EnergyOf(maps)),
                std::numeric_limits<double>::infinity());
    }
  }
}

TEST(PlanKeeper, HoldsWhatFellOutAndLeavesTheOtherMapsAlone) {
  int num_held = 0, num_left_alone = 0, num_maps = 0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const testing::PlanWalk walk(seed, 2, 0.3);
    for (const Light& light : walk.lights) {
      const PlanOptions options = OptionsOf(4);
      const auto plan = FitPlan(walk.frames[0], light, options);
      ASSERT_THAT(plan, IsOk());
      FitOptions fit = options.fit;
      fit.border = BorderChoice::kAutomatic;
      const auto view = ViewLight(walk.frames[1], light, Border::kLit, fit);
      const auto rays = FindServedRays(*view, fit);
      const KeptMaps before = MapsOf(*view, *plan);
      const PlanKeeper keeper(*view, *rays, before, options, fit);
      KeptMaps maps = before;
      if (keeper.HeldBy(maps).HoldsAll()) continue;
      const auto held = keeper.HoldAll(&maps);
      if (!held.has_value()) continue;
      ++num_held;
      EXPECT_TRUE(held->HoldsAll());
      EXPECT_EQ(held->held_by, keeper.HeldBy(maps).held_by);
      for (size_t k = 0; k < maps.size(); ++k) {
        const bool is_same = maps[k].map_from_world == before[k].map_from_world;
        EXPECT_EQ(is_same, maps[k].action == TrackerAction::kKept);
        num_left_alone += is_same ? 1 : 0;
        ++num_maps;
      }
    }
  }
  std::printf("%d plans mended, %d of %d maps left alone\n", num_held, num_left_alone, num_maps);
  EXPECT_GT(num_held, 4);
  EXPECT_GT(num_left_alone, num_maps / 3);
}

TEST(PlanKeeper, LowersTheEnergyToWhatWasAskedOrLeavesTheMapsAsTheyAre) {
  int num_lowered = 0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      const PlanOptions options = OptionsOf(3);
      PlanOptions wasteful = options;
      wasteful.fit.margin_percent = 40.0;
      const auto plan = FitPlan(at.surfaces, at.light, wasteful);
      ASSERT_THAT(plan, IsOk());
      const KeptMaps before = MapsOf(at.view, *plan);
      const PlanKeeper keeper(at.view, at.rays, before, options, at.fit);
      const double energy = keeper.costs().EnergyOf(before);
      const double tight = keeper.TightEnergyOf(before, keeper.HeldBy(before));
      EXPECT_LT(tight, energy);
      KeptMaps maps = before;
      const double most = 0.5 * (energy + tight);
      const double price = keeper.LowerEnergy(most, &maps);
      if (std::isfinite(price)) {
        ++num_lowered;
        EXPECT_LE(keeper.costs().EnergyOf(maps), most);
        EXPECT_TRUE(keeper.HeldBy(maps).HoldsAll());
        EXPECT_NEAR(price, keeper.costs().PriceOf(maps, most), 1e-9 * price);
      }
      KeptMaps hopeless = before;
      EXPECT_EQ(keeper.LowerEnergy(0.01 * tight, &hopeless),
                std::numeric_limits<double>::infinity());
      for (size_t k = 0; k < before.size(); ++k) {
        EXPECT_EQ(hopeless[k].map_from_world, before[k].map_from_world);
      }
    }
  }
  EXPECT_GT(num_lowered, 5);
}

}  // namespace
}  // namespace lightfit
