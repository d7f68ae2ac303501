#include "partition/published/plan_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "methods/view_body.h"
#include "partition/published/storage_factor.h"
#include "tests/methods/random_input.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

TEST(SizeOfAspect, KeepsToItsTexels) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const int min_side = random.Int(1, 20);
    const double texels = min_side * min_side * random.LogUniform(1.0, 1e6);
    const double aspect = random.LogUniform(1e-4, 1e4);
    const MapSize size = SizeOfAspect(texels, aspect, min_side);
    const double product = 1.0 * size.width * size.height;
    EXPECT_LE(product, texels);
    EXPECT_GE(std::min(size.width, size.height), min_side);
    EXPECT_LE(std::max(size.width, size.height), kMaxMapSide);
    // Where no limit is near, both are met up to whole texels.
    const double width = std::sqrt(texels * aspect), height = std::sqrt(texels / aspect);
    if (std::min(width, height) < 2.0 * min_side || std::max(width, height) > kMaxMapSide) continue;
    EXPECT_NEAR(size.width, width, 0.5 + 1e-9);
    EXPECT_GT(product, texels - size.width);
  }
}

// Parts of a random view at several depths, as they come.
std::vector<PlanPart> RandomParts(const MethodInput& input, Random& random) {
  std::vector<PlanPart> parts;
  MethodInput part = input;
  part.map = {1, 1};
  const int num_parts = random.Int(1, 8);
  for (int i = 0; i < num_parts; ++i) {
    part.camera.near = random.LogUniform(1.0, 10.0);
    part.camera.far = part.camera.near * random.LogUniform(1.2, 20.0);
    std::vector<Eigen::Vector3d> corners = ViewBody(part.camera, part.receivers);
    parts.push_back({SetUpMap(Method::kLispsm, part)->map_from_world, {}, std::move(corners)});
    parts.back().half_spaces.push_back(Eigen::Vector4d(0.0, 0.0, -1.0, -part.camera.near));
  }
  return parts;
}

TEST(PlanOfParts, KeepsToTheBudgetInEveryShape) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    MethodInput input = testing::LevelView(random.UnitVector());
    input.map = {random.Int(1, 1000), random.Int(1, 1000)};
    const std::vector<PlanPart> parts = RandomParts(input, random);
    const double margin = random.Coin() ? 0.0 : random.Uniform(0.0, 3.0);
    for (const PlanShapes shapes :
         {PlanShapes::kEqualSquares, PlanShapes::kAspects, PlanShapes::kByStorage}) {
      const absl::StatusOr<Plan> plan = PlanOfParts(input, parts, shapes, margin);
      if (!plan.ok()) {
        EXPECT_THAT(plan, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("more texels")));
        continue;
      }
      EXPECT_LE(NumTexels(*plan), int64_t{input.map.width} * input.map.height);
      ASSERT_EQ(plan->maps.size(), parts.size());
      EXPECT_EQ(plan->light_name, "sun");
      for (size_t k = 0; k < parts.size(); ++k) {
        const PlanMap& map = plan->maps[k];
        ASSERT_EQ(map.half_spaces.size(), 1);
        EXPECT_EQ(map.half_spaces[0].transpose(), parts[k].half_spaces[0]);
        EXPECT_GT(std::min(map.size.width, map.size.height), 2.0 * margin);
        for (const Eigen::Vector3d& corner : parts[k].corners) {
          const Eigen::Vector2d texel =
              (map.map_from_world * corner.homogeneous()).hnormalized().head<2>();
          EXPECT_GE(texel.minCoeff(), margin);
          EXPECT_LE(texel.x(), map.size.width - margin);
          EXPECT_LE(texel.y(), map.size.height - margin);
        }
      }
    }
  }
}

struct Spread {
  double within = 1.0;   // largest ratio of a map's two errors
  double between = 1.0;  // of the products of two maps' errors
};

Spread SpreadOf(const MethodInput& input, const std::vector<PlanPart>& parts, PlanShapes shapes) {
  const absl::StatusOr<Plan> plan = PlanOfParts(input, parts, shapes, 0.0);
  EXPECT_THAT(plan, IsOk());
  Spread spread;
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  for (size_t k = 0; k < parts.size(); ++k) {
    const auto errors =
        MaxBeamErrors(plan->maps[k].map_from_world, input.light, input.camera, parts[k].corners);
    EXPECT_THAT(errors, IsOk());
    spread.within = std::max({spread.within, errors->u / errors->v, errors->v / errors->u});
    least = std::min(least, errors->u * errors->v);
    greatest = std::max(greatest, errors->u * errors->v);
  }
  spread.between = greatest / least;
  return spread;
}

// (13), (14), and what follows for several maps.
TEST(PlanOfParts, MakesErrorsAlike) {
  constexpr double kWholeTexels = 1.02;
  Random random(3);
  double squares = 1.0, aspects = 1.0;
  for (int i = 0; i < 30; ++i) {
    MethodInput input = testing::LevelView(random.UnitVector());
    input.map = {20000, 20000};
    const std::vector<PlanPart> parts = RandomParts(input, random);
    squares = std::max(squares, SpreadOf(input, parts, PlanShapes::kEqualSquares).within);
    const Spread with_aspects = SpreadOf(input, parts, PlanShapes::kAspects);
    EXPECT_LT(with_aspects.within, kWholeTexels);
    aspects = std::max(aspects, with_aspects.between);
    const Spread by_storage = SpreadOf(input, parts, PlanShapes::kByStorage);
    EXPECT_LT(by_storage.within, kWholeTexels);
    EXPECT_LT(by_storage.between, kWholeTexels);
  }
  EXPECT_GT(squares, 2.0);
  EXPECT_GT(aspects, 2.0);
}

TEST(PlanOfParts, SaysWhatIsTooMuch) {
  MethodInput input = testing::LevelView({0.0, -1.0, 0.0});
  PlanPart part;
  part.map_from_world = SetUpMap(Method::kFocused, input)->map_from_world;
  EXPECT_THAT(PlanOfParts(input, {}, PlanShapes::kAspects, 0.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("a plan of 0 maps")));
  EXPECT_THAT(
      PlanOfParts(input, std::vector<PlanPart>(kMaxPlanMaps + 1, part), PlanShapes::kAspects, 0.0),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("want 1 ... 32")));
  input.map = {2, 2};
  EXPECT_THAT(PlanOfParts(input, std::vector<PlanPart>(5, part), PlanShapes::kAspects, 0.0),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("map = 2x2: 5 equal maps")));
  // Nothing in view of them: as many texels for each.
  const auto plan = PlanOfParts(input, {part, part}, PlanShapes::kByStorage, 0.0);
  ASSERT_THAT(plan, IsOk());
  EXPECT_EQ(NumTexels(*plan), 4);
  EXPECT_EQ(plan->maps[0].size.width * plan->maps[0].size.height, 2);
}

}  // namespace
}  // namespace lightfit
