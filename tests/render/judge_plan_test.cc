#include "render/judge_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "geometry/homography.h"
#include "render/shadow_map.h"
#include "tests/render/plan_stage.h"
#include "tests/render/texel_verdict.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlanStage;
using testing::Random;
using testing::RandomLightAbove;
using testing::RandomPlan;
using testing::StatusIs;
using testing::Verdict;

ShadowImage Judged(const PlanStage& stage, const Plan& plan, int phases = 1) {
  JudgeOptions options;
  options.phases = phases;
  auto judged = JudgePlan(stage.caster, stage.image, stage.truth, stage.light, plan, options);
  EXPECT_THAT(judged, IsOk());
  return judged.ok() ? *std::move(judged) : ShadowImage();
}

ShadowImage Judged(const PlanStage& stage, const JudgedMap& map, int phases = 1) {
  JudgeOptions options;
  options.phases = phases;
  auto judged = JudgeMatrix(stage.caster, stage.image, stage.truth, stage.light, map, options);
  EXPECT_THAT(judged, IsOk());
  return judged.ok() ? *std::move(judged) : ShadowImage();
}

void ExpectSame(const ShadowImage& a, const ShadowImage& b) {
  EXPECT_EQ(a.ideal, b.ideal);
  EXPECT_EQ(a.practical, b.practical);
  EXPECT_EQ(a.wrong.ideal, b.wrong.ideal);
  EXPECT_EQ(a.wrong.practical, b.wrong.practical);
  EXPECT_EQ(a.wrong.practical_weighted, b.wrong.practical_weighted);
  EXPECT_EQ(a.wrong.outside, b.wrong.outside);
}

Plan PlanOfOne(const PlanMap& map, Border border) {
  Plan plan;
  plan.border = border;
  plan.maps.push_back(map);
  return plan;
}

TEST(JudgePlan, OfOneMapIsJudgeMatrix) {
  int64_t num_wrong = 0, num_outside = 0;
  for (uint64_t seed = 701; seed < 709; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const PlanMap part = testing::RandomPart(stage, random);
    const Border border = random.Coin() ? Border::kLit : Border::kDark;
    for (const int phases : {1, 4}) {
      const ShadowImage of_plan = Judged(stage, PlanOfOne(part, border), phases);
      ExpectSame(of_plan, Judged(stage, {part.map_from_world, part.size, border}, phases));
      num_wrong += of_plan.wrong.ideal;
      num_outside += of_plan.wrong.outside;
    }
  }
  EXPECT_GT(num_wrong, 1000);
  EXPECT_GT(num_outside, 100);
}

// What the guard keeps from being asked might as well not be there: the map without its rim, of
// which every texel is where it was.
TEST(JudgePlan, AGuardLeavesTheMapWithoutItsRim) {
  constexpr int kGuard = 3;
  int64_t num_more_outside = 0;
  for (uint64_t seed = 721; seed < 727; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const PlanMap part = testing::RandomPart(stage, random);
    const Border border = random.Coin() ? Border::kLit : Border::kDark;
    const MapSize inner = {part.size.width - 2 * kGuard, part.size.height - 2 * kGuard};
    const Eigen::Vector2d to_inner = Eigen::Vector2d::Constant(-kGuard);
    const Plan cut =
        PlanOfOne(testing::PlanMapOf(testing::Moved(part.map_from_world, to_inner), inner), border);
    for (const int phases : {1, 4}) {
      JudgeOptions options;
      options.phases = phases;
      const auto guarded = JudgePlan(stage.caster,
                                     stage.image,
                                     stage.truth,
                                     stage.light,
                                     PlanOfOne(part, border),
                                     options,
                                     kGuard);
      ASSERT_THAT(guarded, IsOk());
      const ShadowImage without_rim = Judged(stage, cut, phases);
      EXPECT_EQ(guarded->ideal, without_rim.ideal);
      EXPECT_EQ(guarded->wrong.ideal, without_rim.wrong.ideal);
      EXPECT_EQ(guarded->wrong.outside, without_rim.wrong.outside);
      num_more_outside +=
          guarded->wrong.outside - Judged(stage, PlanOfOne(part, border), phases).wrong.outside;
    }
  }
  EXPECT_GT(num_more_outside, 100);
}

TEST(JudgePlan, TwoEqualMapsSplitByAPlaneAreTheOneMap) {
  for (uint64_t seed = 711; seed < 717; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const PlanMap part = testing::RandomPart(stage, random);
    const Plan one = PlanOfOne(part, random.Coin() ? Border::kLit : Border::kDark);
    Plan two = one;
    two.maps.push_back(part);
    const auto [side, other_side] = testing::RandomSplit(random);
    two.maps[0].half_spaces.push_back(side);
    two.maps[1].half_spaces.push_back(other_side);
    for (const int phases : {1, 4}) {
      ExpectSame(Judged(stage, two, phases), Judged(stage, one, phases));
    }
    // Whoever only the second may serve finds the border.
    two.maps.pop_back();
    EXPECT_NE(Judged(stage, two).ideal, Judged(stage, one).ideal);
  }
}

TEST(JudgePlan, ACoarserMapOfTheSameRaysIsNeverAsked) {
  for (uint64_t seed = 721; seed < 725; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    // Its margin of 1 % is more than the half of a texel that phases move it by.
    const MapSize size = {64, 60}, half_size = {32, 30};
    const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
    const Eigen::Matrix3d halved = Eigen::Vector3d(0.5, 0.5, 1.0).asDiagonal();
    const PlanMap coarse = testing::PlanMapOf(testing::Changed(halved, matrix), half_size);
    Plan plan = PlanOfOne(testing::PlanMapOf(matrix, size), Border::kLit);
    const ShadowImage fine = Judged(stage, plan, 4);
    plan.maps.push_back(coarse);
    ExpectSame(Judged(stage, plan, 4), fine);
    std::swap(plan.maps[0], plan.maps[1]);
    ExpectSame(Judged(stage, plan, 4), fine);
    EXPECT_NE(Judged(stage, PlanOfOne(coarse, Border::kLit), 4).ideal, fine.ideal);
  }
}

TEST(JudgePlan, FourQuartersOfTheSameSizeAreLessWrongThanOneMap) {
  for (uint64_t seed = 731; seed < 734; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const MapSize size = {48, 48};
    const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
    Plan quarters;
    for (const double u : {0.0, 48.0}) {
      for (const double v : {0.0, 48.0}) {
        Eigen::Matrix3d quarter_from_map;
        quarter_from_map << 2.0, 0.0, -u, 0.0, 2.0, -v, 0.0, 0.0, 1.0;
        quarters.maps.push_back(
            testing::PlanMapOf(testing::Changed(quarter_from_map, matrix), size));
      }
    }
    const WrongPixels one = Judged(stage, JudgedMap{matrix, size}, 4).wrong;
    const WrongPixels four = Judged(stage, quarters, 4).wrong;
    EXPECT_GT(one.ideal, 20);
    EXPECT_LT(four.ideal, 0.75 * one.ideal);
  }
}

// What the texel that PlanLookUp names says of the receiver.
class ByHand {
 public:
  ByHand(const PlanStage& stage, const Plan& plan)
      : stage_(stage), plan_(plan), look_up_(*PlanLookUp::Create(plan, stage.light)) {}

  const PlanLookUp& look_up() const { return look_up_; }

  Verdict At(const SurfacePoint& pixel) const {
    const PlanPlace place = look_up_.At(pixel.position);
    if (place.map < 0) return {true, plan_.border == Border::kDark, plan_.border == Border::kDark};
    if (testing::IsOnATexelsEdge(place.texel)) return {};
    const Eigen::Vector2d centre = testing::CentreOfTexelAt(place.texel);
    const Eigen::Matrix3d map_from_ray =
        *MapFromRay(plan_.maps[place.map].map_from_world, stage_.light);
    const auto ray =
        MapRays(stage_.light, map_from_ray, stage_.caster.bounds()).At(centre.x(), centre.y());
    return testing::VerdictOf(stage_.caster.scene(), pixel, *ray);
  }

 private:
  const PlanStage& stage_;
  const Plan& plan_;
  PlanLookUp look_up_;
};

TEST(JudgePlan, IsBruteForceOfTheMapsThatTheLookUpNames) {
  int num_compared = 0, num_dark = 0, num_skipped = 0, num_outside = 0, num_cut = 0;
  for (uint64_t seed = 741; seed < 749; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random), 48, 36);
    const Plan plan = RandomPlan(stage, random, random.Int(2, 6));
    for (const int phases : {1, 4}) {
      const ShadowImage judged = Judged(stage, plan, phases);
      // Phase 0 of 4 is moved by a quarter of a texel.
      const Plan moved = testing::Moved(plan, Eigen::Vector2d::Constant(phases == 1 ? 0.0 : -0.25));
      const ByHand by_hand(stage, moved);
      for (size_t i = 0; i < stage.truth.size(); ++i) {
        const SurfacePoint& pixel = stage.image.pixels[i];
        if (!IsJudged(stage.truth[i])) {
          EXPECT_EQ(judged.ideal[i], stage.truth[i]);
          EXPECT_EQ(judged.practical[i], stage.truth[i]);
          continue;
        }
        const Verdict verdict = by_hand.At(pixel);
        num_skipped += !verdict.is_known;
        if (!verdict.is_known) continue;
        ++num_compared;
        num_dark += verdict.ideal;
        num_outside += by_hand.look_up().At(pixel.position).map < 0;
        for (int k = 0; k < by_hand.look_up().num_maps(); ++k) {
          num_cut += !by_hand.look_up().IsServed(k, pixel.position);
        }
        EXPECT_EQ(judged.ideal[i] == Lighting::kShadowed, verdict.ideal) << "pixel " << i;
        if (verdict.practical_is_close) continue;
        EXPECT_EQ(judged.practical[i] == Lighting::kShadowed, verdict.practical) << "pixel " << i;
      }
    }
  }
  std::printf("%d compared, %d of them dark, %d outside; %d half spaces against; %d skipped\n",
              num_compared,
              num_dark,
              num_outside,
              num_cut,
              num_skipped);
  EXPECT_GT(num_compared, 5000);
  EXPECT_GT(num_dark, 500);
  EXPECT_GT(num_outside, 100);
  EXPECT_GT(num_cut, 1000);
  EXPECT_LT(num_skipped, num_compared / 4);
}

// The definition: every phase is the plan of maps moved by hand, judged by itself.
TEST(JudgePlan, CountsAreTheMeanOverMovedPlans) {
  // Of a mean over phases: a pixel at an edge that one of the two matrices rounds to the other
  // side.
  constexpr double kRoundedPixels = 0.5;
  for (uint64_t seed = 751; seed < 755; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const Plan plan = RandomPlan(stage, random, random.Int(2, 6));
    for (const int n : {2, 3}) {
      SCOPED_TRACE(absl::StrCat(stage.light.name, ", ", n, " x ", n, " phases"));
      const ShadowImage judged = Judged(stage, plan, n * n);
      double ideal = 0.0, practical = 0.0, weighted = 0.0, outside = 0.0;
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          const Eigen::Vector2d move((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5);
          const WrongPixels wrong = Judged(stage, testing::Moved(plan, move)).wrong;
          ideal += static_cast<double>(wrong.ideal) / (n * n);
          practical += static_cast<double>(wrong.practical) / (n * n);
          weighted += wrong.practical_weighted / (n * n);
          outside += static_cast<double>(wrong.outside) / (n * n);
        }
      }
      EXPECT_GT(ideal, 10.0);
      EXPECT_NEAR(static_cast<double>(judged.wrong.ideal), ideal, 0.5 + kRoundedPixels);
      EXPECT_NEAR(static_cast<double>(judged.wrong.practical), practical, 0.5 + kRoundedPixels);
      EXPECT_NEAR(static_cast<double>(judged.wrong.outside), outside, 0.5 + kRoundedPixels);
      EXPECT_NEAR(judged.wrong.practical_weighted, weighted, kRoundedPixels);
      JudgeOptions options;
      options.phases = n * n;
      const auto first =
          JudgePlanFirstPhase(stage.caster, stage.image, stage.truth, stage.light, plan, options);
      ASSERT_THAT(first, IsOk());
      EXPECT_EQ(first->ideal, judged.ideal);
      EXPECT_EQ(first->practical, judged.practical);
    }
  }
}

TEST(JudgePlan, ReceiversThatNoMapHoldsFindTheBorder) {
  int64_t num_outside = 0;
  for (uint64_t seed = 761; seed < 766; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    Plan plan = RandomPlan(stage, random, 2);
    const auto look_up = PlanLookUp::Create(plan, stage.light);
    ASSERT_THAT(look_up, IsOk());
    plan.border = Border::kLit;
    const ShadowImage lit = Judged(stage, plan);
    plan.border = Border::kDark;
    const ShadowImage dark = Judged(stage, plan);
    int64_t num_lit_outside = 0, num_dark_outside = 0;
    for (size_t i = 0; i < stage.truth.size(); ++i) {
      if (!IsJudged(stage.truth[i])) continue;
      if (look_up->At(stage.image.pixels[i].position).map >= 0) {
        EXPECT_EQ(lit.ideal[i], dark.ideal[i]);
        EXPECT_EQ(lit.practical[i], dark.practical[i]);
        continue;
      }
      ++(stage.truth[i] == Lighting::kLit ? num_lit_outside : num_dark_outside);
      EXPECT_EQ(lit.ideal[i], Lighting::kLit);
      EXPECT_EQ(lit.practical[i], Lighting::kLit);
      EXPECT_EQ(dark.ideal[i], Lighting::kShadowed);
      EXPECT_EQ(dark.practical[i], Lighting::kShadowed);
    }
    num_outside += num_lit_outside + num_dark_outside;
    EXPECT_EQ(lit.wrong.outside, num_dark_outside);
    EXPECT_EQ(dark.wrong.outside, num_lit_outside);
  }
  EXPECT_GT(num_outside, 1000);
}

TEST(JudgePlan, IsTheSameOnAnyNumberOfThreads) {
  const auto judged = [](int num_threads) {
    Random random(771);
    const PlanStage stage(771, RandomLightAbove(random), 192, 144, num_threads);
    return Judged(stage, RandomPlan(stage, random, 5), 4);
  };
  const ShadowImage one = judged(1);
  for (const int num_threads : {2, 5}) ExpectSame(judged(num_threads), one);
}

TEST(JudgePlan, RefusesWhatItCannotJudge) {
  Random random(781);
  const PlanStage stage(781, Light::Directional("sun", {1.0, 0.7, -0.8}));
  const Plan good = RandomPlan(stage, random, 3);
  const auto judge = [&](const Plan& plan, const Light& light, const JudgeOptions& options = {}) {
    return JudgePlan(stage.caster, stage.image, stage.truth, light, plan, options);
  };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(judge(good, stage.light), IsOk());
  EXPECT_THAT(judge(good, Light::Point("lamp", {1, 2, 9})),
              StatusIs(kInvalid, HasSubstr("do not leave the light")));
  EXPECT_THAT(judge({}, stage.light), StatusIs(kInvalid, HasSubstr("plan of 0 maps")));
  EXPECT_THAT(judge(good, stage.light, {.phases = 2}),
              StatusIs(kInvalid, HasSubstr("phases = 2, want a square")));
  EXPECT_THAT(judge(good, stage.light, {.constant_share = std::nan("")}),
              StatusIs(kInvalid, HasSubstr("constant_share")));
  EXPECT_THAT(JudgePlan(stage.caster, stage.image, {}, stage.light, good),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
  EXPECT_THAT(JudgePlanFirstPhase(stage.caster, stage.image, {}, stage.light, good),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));

  Plan plan = good;
  plan.maps[1].size = {16, 0};
  EXPECT_THAT(judge(plan, stage.light), StatusIs(kInvalid, HasSubstr("16x0")));
  plan.maps[1].size = {65536, 65536};
  EXPECT_THAT(judge(plan, stage.light), StatusIs(kInvalid, HasSubstr("65536x65536")));
  // Each within the limit, but not both.
  plan.maps[0].size = plan.maps[1].size = {32768, 32768};
  EXPECT_THAT(judge(plan, stage.light),
              StatusIs(kInvalid, HasSubstr("3 maps have more than 1073741824 texels in all")));
  plan = good;
  plan.maps[2].map_from_world(0, 1) = std::nan("");
  EXPECT_THAT(judge(plan, stage.light), StatusIs(kInvalid, HasSubstr("not finite")));
}

}  // namespace
}  // namespace lightfit
