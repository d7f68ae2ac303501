// The split of a budget, against dense scans and exhaustive search.
#include "optimizer/sizing/allocation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "optimizer/fit.h"
#include "optimizer/sizing/map_shapes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;
using testing::TestScene;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

double Cost(const std::vector<double>& factors,
            const std::vector<double>& texels,
            double exponent) {
  double cost = 0.0;
  for (size_t i = 0; i < factors.size(); ++i) cost += factors[i] * std::pow(texels[i], -exponent);
  return cost;
}

double Sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// math.md (16) against moving texels from any light to any other.
TEST(SplitTexels, CannotBeBetteredByMovingTexels) {
  constexpr double kBudget = 1e6, kTolerance = 1e-9;
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> factors;
    for (int n = random.Int(1, 8); n > 0; --n) factors.push_back(random.LogUniform(1e-3, 1e3));
    const double exponent = random.Coin() ? 1.0 : 0.5;
    const TexelLimits limits = {random.Uniform(1e3, 1e5), random.Uniform(3e5, 2e6)};
    const std::vector<double> texels = SplitTexels(factors, exponent, kBudget, limits);
    const double expected = std::min(kBudget, limits.most * static_cast<double>(factors.size()));
    EXPECT_NEAR(Sum(texels) / expected, 1.0, kTolerance);
    const double cost = Cost(factors, texels, exponent);
    for (size_t from = 0; from < factors.size(); ++from) {
      EXPECT_GE(texels[from], limits.least);
      EXPECT_LE(texels[from], limits.most);
      for (size_t to = 0; to < factors.size(); ++to) {
        for (const double share : {1e-3, 0.1}) {
          std::vector<double> moved = texels;
          moved[from] -= share * texels[from];
          moved[to] += share * texels[from];
          if (moved[from] < limits.least || moved[to] > limits.most) continue;
          EXPECT_GE(Cost(factors, moved, exponent), cost * (1.0 - kTolerance));
        }
      }
    }
  }
}

TEST(SplitTexels, HasTheClosedFormWithoutLimits) {
  const std::vector<double> factors = {1.0, 8.0, 27.0};
  const TexelLimits none = {1e-6, 1e12};
  const std::vector<double> squares = SplitTexels(factors, 1.0, 1.0, none);
  const double root_sum = 1.0 + std::sqrt(8.0) + std::sqrt(27.0);
  EXPECT_NEAR(squares[1], std::sqrt(8.0) / root_sum, 1e-9);
  const std::vector<double> footprints = SplitTexels(factors, 0.5, 1.0, none);
  EXPECT_NEAR(footprints[1], 4.0 / (1.0 + 4.0 + 9.0), 1e-9);  // the power 2/3
}

// Sizes of maps of random shapes, as AllocateBudget() chooses among.
std::vector<RatedSize> RandomSizes(Random& random, double exponent, const MapSizeRules& rules) {
  MapShapes shapes;
  for (int i = 0; i < 3; ++i) {
    const double product = random.LogUniform(1.0, 2.0), aspect = random.LogUniform(1.0, 8.0);
    shapes.shapes.push_back({product * aspect, product / aspect});
  }
  shapes.footprint_sum = exponent == 0.5 ? 1.0 : 0.0;
  return RateSizes(shapes, random.LogUniform(0.1, 10.0), rules);
}

double ExhaustiveCost(const std::vector<std::vector<RatedSize>>& sizes,
                      size_t light,
                      int64_t budget_texels) {
  if (light == sizes.size()) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const RatedSize& size : sizes[light]) {
    if (size.texels > budget_texels) break;
    least =
        std::min(least, size.cost + ExhaustiveCost(sizes, light + 1, budget_texels - size.texels));
  }
  return least;
}

// Exact where the budget has few enough steps; with sides of any texels, how near is printed.
TEST(ChooseSizes, FindsWhatExhaustiveSearchFinds) {
  Random random(4);
  MapSizeRules multiples, powers, any;
  multiples.multiple = multiples.min_side = 128;
  multiples.max_side = 1536;
  powers.powers_of_two = true;
  powers.max_side = 4096;
  any.multiple = any.min_side = 1;
  any.max_side = 200;
  double worst_exact = 1.0, worst_any = 1.0;
  for (int i = 0; i < 240; ++i) {
    const MapSizeRules& rules = i % 3 == 0 ? multiples : i % 3 == 1 ? powers : any;
    const bool is_exact = i % 3 != 2;
    const int num_lights = is_exact ? random.Int(2, i % 3 == 0 ? 3 : 4) : 2;
    const double exponent = random.Coin() ? 1.0 : 0.5;
    std::vector<std::vector<RatedSize>> sizes;
    for (int n = 0; n < num_lights; ++n) sizes.push_back(RandomSizes(random, exponent, rules));
    const auto budget_texels = static_cast<int64_t>(
        num_lights * (is_exact ? random.LogUniform(3e4, 1.5e6) : random.LogUniform(1e4, 3e4)));
    const std::vector<size_t> chosen = ChooseSizes(sizes, budget_texels);
    double cost = 0.0;
    int64_t texels = 0;
    for (int n = 0; n < num_lights; ++n) {
      cost += sizes[n][chosen[n]].cost;
      texels += sizes[n][chosen[n]].texels;
    }
    ASSERT_LE(texels, budget_texels);
    double& worst = is_exact ? worst_exact : worst_any;
    worst = std::max(worst, cost / ExhaustiveCost(sizes, 0, budget_texels));
  }
  std::printf(
      "cost / least cost, worst: %.12f, with sides of any texels %.6f\n", worst_exact, worst_any);
  EXPECT_LE(worst_exact, 1.0 + 1e-12);
  EXPECT_LE(worst_any, 1.001);
}

std::vector<AllocationLight> LightsOf(const TestScene& scene, const FitOptions& options) {
  std::vector<AllocationLight> lights;
  for (const Light& light : scene.lights) {
    lights.push_back({light, SummarizeForAnyAspect(scene.View(), light, options)});
  }
  return lights;
}

TEST(AllocateBudget, KeepsTheBudgetAndBeatsAnEqualSplit) {
  Random random(5);
  int num_fitted = 0;
  for (const int seed : {1, 2, 3}) {
    const TestScene scene(seed, 3);
    for (const Metric metric : {Metric::kL2, Metric::kL1AcrossEdge}) {
      FitOptions options;
      options.metric = metric;
      const std::vector<AllocationLight> lights = LightsOf(scene, options);
      const auto budget_texels = static_cast<int64_t>(random.LogUniform(2e5, 2e7));
      const absl::StatusOr<Allocation> allocation =
          AllocateBudget(lights, budget_texels, MapSizeRules(), options);
      ASSERT_TRUE(allocation.ok()) << allocation.status();
      int num_maps = 0;
      int64_t texels = 0;
      double energy = 0.0;
      for (const AllocatedMap& map : allocation->maps) {
        if (!map.matrix.ok()) continue;
        ++num_maps;
        texels += TexelsOf(map.matrix->map);
        energy += map.matrix->figures.energy;
        EXPECT_EQ(map.matrix->map.width % 64, 0);
        EXPECT_EQ(map.matrix->map.height % 64, 0);
        EXPECT_NEAR(
            map.matrix->figures.energy / map.ideal_energy, 1.0, 0.25);  // at sides of few 64s
      }
      EXPECT_EQ(texels, allocation->texels);
      EXPECT_LE(texels, budget_texels);
      EXPECT_NEAR(energy / allocation->energy, 1.0, 1e-12);
      EXPECT_GE(allocation->energy, allocation->ideal_energy * 0.999);
      const int side = static_cast<int>(std::sqrt(budget_texels / num_maps));
      double equal = 0.0;
      for (size_t i = 0; i < lights.size(); ++i) {
        if (!allocation->maps[i].matrix.ok()) continue;
        const absl::StatusOr<LightMatrix> fit =
            Fit(*lights[i].summary, lights[i].light, {side, side}, options);
        ASSERT_TRUE(fit.ok()) << fit.status();
        equal += fit->figures.energy;
      }
      EXPECT_LT(allocation->ideal_energy, equal * 1.001);
      if (budget_texels > 2'000'000) {
        EXPECT_LT(allocation->energy, equal);
      }
      num_fitted += num_maps;
    }
  }
  EXPECT_GT(num_fitted, 12);
}

TEST(AllocateBudget, GivesMoreToALightOfMoreWeight) {
  const TestScene scene(1, 3);
  const FitOptions options;
  std::vector<AllocationLight> lights = LightsOf(scene, options);
  const absl::StatusOr<Allocation> equal =
      AllocateBudget(lights, 4'000'000, MapSizeRules(), options);
  ASSERT_TRUE(equal.ok()) << equal.status();
  ASSERT_TRUE(equal->maps[0].matrix.ok()) << equal->maps[0].matrix.status();
  lights[0].weight = 4.0;
  const absl::StatusOr<Allocation> weighted =
      AllocateBudget(lights, 4'000'000, MapSizeRules(), options);
  ASSERT_TRUE(weighted.ok()) << weighted.status();
  EXPECT_GT(weighted->maps[0].ideal_texels, 1.2 * equal->maps[0].ideal_texels);
  EXPECT_LT(weighted->maps[0].matrix->figures.energy, equal->maps[0].matrix->figures.energy);
}

TEST(AllocateBudget, OneFailingLightLeavesItsTexelsToTheOthers) {
  const TestScene scene(1, 2);
  const FitOptions options;
  std::vector<AllocationLight> lights = LightsOf(scene, options);
  const absl::StatusOr<Allocation> before =
      AllocateBudget(lights, 1'000'000, MapSizeRules(), options);
  lights.insert(lights.begin(),
                {Light::Directional("moon", {0, 0, -1}, 5),
                 absl::FailedPreconditionError("light \"moon\": no shadow boundary")});
  const absl::StatusOr<Allocation> after =
      AllocateBudget(lights, 1'000'000, MapSizeRules(), options);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_THAT(after->maps[0].matrix,
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no shadow boundary")));
  EXPECT_EQ(after->texels, before->texels);
  for (size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(before->maps[i].matrix.ok()) << before->maps[i].matrix.status();
    EXPECT_EQ(after->maps[i + 1].matrix->map_from_world, before->maps[i].matrix->map_from_world);
  }
}

TEST(AllocateBudget, SaysWhatIsWrong) {
  const TestScene scene(1, 2);
  const FitOptions options;
  std::vector<AllocationLight> lights = LightsOf(scene, options);
  EXPECT_THAT(AllocateBudget(lights, 0, MapSizeRules(), options),
              StatusIs(kInvalid, HasSubstr("budget_texels = 0, want at least 1")));
  EXPECT_THAT(AllocateBudget(lights, 5000, MapSizeRules(), options),
              StatusIs(kInvalid, HasSubstr("want at least 8192: 2 maps of 64x64")));
  MapSizeRules rules;
  rules.multiple = -1;
  EXPECT_THAT(AllocateBudget(lights, 1'000'000, rules, options),
              StatusIs(kInvalid, HasSubstr("rules.multiple = -1")));
  FitOptions margins;
  margins.margin_texels = 32.0;
  EXPECT_THAT(AllocateBudget(lights, 1'000'000, MapSizeRules(), margins),
              StatusIs(kInvalid, HasSubstr("more than twice options.margin_texels = 32")));
  lights[1].weight = std::nan("");
  EXPECT_THAT(AllocateBudget(lights, 1'000'000, MapSizeRules(), options),
              StatusIs(kInvalid, HasSubstr("weight = nan, want a number above 0")));
}

TEST(AllocateBudget, NothingToDoIsAResult) {
  const absl::StatusOr<Allocation> allocation = AllocateBudget({}, 1'000'000, MapSizeRules());
  ASSERT_TRUE(allocation.ok()) << allocation.status();
  EXPECT_TRUE(allocation->maps.empty());
  EXPECT_EQ(allocation->texels, 0);
}

TEST(AllocateBudget, LeavesWhatTheLargestMapsCannotUse) {
  const TestScene scene(1, 2);
  const FitOptions options;
  MapSizeRules rules;
  rules.max_side = 512;
  const absl::StatusOr<Allocation> allocation =
      AllocateBudget(LightsOf(scene, options), int64_t{1} << 40, rules, options);
  ASSERT_TRUE(allocation.ok()) << allocation.status();
  EXPECT_EQ(allocation->texels, 2 * 512 * 512);
}

}  // namespace
}  // namespace lightfit
