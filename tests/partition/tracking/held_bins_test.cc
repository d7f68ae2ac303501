#include "partition/tracking/held_bins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <set>
#include <utility>
#include <vector>

#include "partition/fit_plan.h"
#include "partition/tracking/kept_map.h"
#include "tests/partition/plan_case.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HasShadows;
using testing::PlanCase;
using testing::Random;

// Maps of the plan, each moved and grown at random so that they hold some and miss some.
ScratchVector<RayMap> RandomMaps(const PlanCase& at, const LightPlan& plan, Random& random) {
  ScratchVector<RayMap> maps;
  for (const LightMatrix& map : plan.maps) {
    Eigen::Matrix4d moved = map.map_from_world;
    const double u = random.Uniform(-0.3, 0.3) * map.map.width;
    const double v = random.Uniform(-0.3, 0.3) * map.map.height;
    moved.row(0) += u * moved.row(3);
    moved.row(1) += v * moved.row(3);
    moved.topRows<2>() *= random.Uniform(0.7, 1.3);
    maps.push_back(MakeKeptMap(at.view, moved, map.map, TrackerAction::kKept)->rays);
  }
  return maps;
}

LightPlan PlanOfCase(const PlanCase& at) {
  PlanOptions options;
  options.max_maps = 4;
  options.texels = 200 * 200;
  options.choose_by_forecast = false;
  return *FitPlan(at.surfaces, at.light, options);
}

// Every pixel by itself, from the definition.
TEST(FindHeldBins, SaysOfEachPixelWhichMapsHoldIt) {
  constexpr double kGuard = 1.5, kHalf = 0.5;
  int num_apart = 0, num_outside = 0, num_held = 0;
  Random random(41);
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      const ScratchVector<RayMap> maps = RandomMaps(at, PlanOfCase(at), random);
      const PixelRays pixels(at.view, at.fit.samples);
      const HeldBins held = FindHeldBins(at.rays, pixels, maps, kGuard);
      num_apart += static_cast<int>(held.rays.bins.size() - at.rays.bins.size());
      ASSERT_EQ(held.held_by.size(), held.rays.bins.size());
      ASSERT_EQ(held.asked.size(), held.rays.bins.size());
      for (size_t i = 0; i < held.rays.bins.size(); ++i) {
        const RayBin& bin = held.rays.bins[i];
        EXPECT_EQ(bin.num_covered, bin.pixels_end - bin.pixels_begin);
        EXPECT_EQ(held.asked[i] < 0, held.held_by[i] == 0);
        if (held.asked[i] >= 0) {
          EXPECT_NE(held.held_by[i] & 1u << held.asked[i], 0u);
        }
        for (int p = bin.pixels_begin; p < bin.pixels_end; ++p) {
          const Eigen::Vector2i& pixel = held.rays.pixels[p];
          ScratchVector<Eigen::Vector3d> corners;
          pixels.AddCorners(
              pixel.x(), pixel.y(), pixels.PlaneAt(pixel.x(), pixel.y()), kHalf, &corners);
          uint32_t by_hand = 0;
          for (size_t k = 0; k < maps.size(); ++k) {
            const bool holds =
                std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& ray) {
                  const Eigen::Vector3d texel = maps[k].map_from_ray * ray;
                  const double u = texel.x() / texel.z(), v = texel.y() / texel.z();
                  return texel.z() > 0.0 && u >= kGuard && v >= kGuard &&
                         u <= maps[k].width - kGuard && v <= maps[k].height - kGuard;
                });
            if (holds) by_hand |= 1u << k;
          }
          // What holds the bin holds its pixels; what no map holds is outside.
          EXPECT_EQ(held.held_by[i] & ~by_hand, 0u);
          if (held.held_by[i] == 0) {
            EXPECT_EQ(by_hand, 0u);
          }
          (by_hand == 0 ? num_outside : num_held) += 1;
        }
      }
      EXPECT_EQ(held.HoldsAll(), held.BinsOutside().empty());
    }
  }
  std::printf("%d bins more; %d pixels held, %d not\n", num_apart, num_held, num_outside);
  EXPECT_GT(num_apart, 50);
  EXPECT_GT(num_held, 1000);
  EXPECT_GT(num_outside, 1000);
}

TEST(FindHeldBins, LosesNoPixelAndNoSample) {
  Random random(42);
  for (int index = 0; index < 3; ++index) {
    const PlanCase at(2, index);
    const ScratchVector<RayMap> maps = RandomMaps(at, PlanOfCase(at), random);
    const PixelRays pixels(at.view, at.fit.samples);
    const HeldBins held = FindHeldBins(at.rays, pixels, maps, 0.0);
    const auto pixels_of = [](const ServedRays& rays) {
      std::multiset<std::pair<int, int>> all;
      for (const RayBin& bin : rays.bins) {
        for (int i = bin.pixels_begin; i < bin.pixels_end; ++i) {
          all.insert({rays.pixels[i].x(), rays.pixels[i].y()});
        }
      }
      return all;
    };
    const auto samples_of = [](const ServedRays& rays) {
      std::multiset<std::pair<double, double>> all;
      for (const RayBin& bin : rays.bins) {
        for (int i = bin.samples_begin; i < bin.samples_end; ++i) {
          all.insert({rays.samples[i].X.x(), rays.samples[i].weight});
        }
      }
      return all;
    };
    EXPECT_EQ(pixels_of(held.rays), pixels_of(at.rays));
    EXPECT_EQ(samples_of(held.rays), samples_of(at.rays));
    EXPECT_EQ(static_cast<int64_t>(held.rays.pixels.size()), at.rays.num_covered);
  }
}

TEST(FindHeldBins, BinsOfAPlanAreAllHeldByIt) {
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      ScratchVector<RayMap> maps;
      for (const LightMatrix& map : PlanOfCase(at).maps) {
        maps.push_back(
            MakeKeptMap(at.view, map.map_from_world, map.map, TrackerAction::kKept)->rays);
      }
      const HeldBins held = FindHeldBins(at.rays, PixelRays(at.view, at.fit.samples), maps, 0.0);
      EXPECT_TRUE(held.HoldsAll()) << seed << " " << index;
      size_t num_asked = 0;
      for (size_t k = 0; k < maps.size(); ++k) {
        const ScratchVector<int> of = held.BinsOf(static_cast<int>(k));
        const ScratchVector<int> in = held.BinsIn(static_cast<int>(k));
        const ScratchVector<int> only = held.BinsOnlyIn(static_cast<int>(k));
        num_asked += of.size();
        EXPECT_TRUE(std::includes(in.begin(), in.end(), of.begin(), of.end()));
        EXPECT_TRUE(std::includes(of.begin(), of.end(), only.begin(), only.end()));
      }
      EXPECT_LE(num_asked, held.rays.bins.size());
      EXPECT_GT(num_asked, held.rays.bins.size() / 2);
      ++num_cases;
    }
  }
  EXPECT_GT(num_cases, 6);
}

}  // namespace
}  // namespace lightfit
