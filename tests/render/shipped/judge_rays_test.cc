#include "render/shipped/judge_rays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "optimizer/readback/surfaces.h"
#include "render/judge_plan.h"
#include "render/readback_image.h"
#include "tests/render/plan_stage.h"
#include "tests/render/shipped/tessellated.h"
#include "tests/render/texel_verdict.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlanStage;
using testing::Random;
using testing::StatusIs;
using testing::Verdict;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

// Among the boxes.
Light RandomLamp(Random& random) {
  return Light::Point(
      "lamp", {random.Uniform(-8.0, 8.0), random.Uniform(-8.0, 8.0), random.Uniform(0.5, 5.0)});
}

Light RandomSun(Random& random) {
  return Light::Directional(
      "sun", {random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-1.0, -0.3)});
}

ParaboloidPair RandomPair(const Light& light, Random& random, int64_t max_texels) {
  return *MakeParaboloidPair(light, random.UnitVector(), max_texels);
}

ShadowImage Judged(const PlanStage& stage, const ParaboloidPair& pair, int phases) {
  auto judged = JudgeParaboloids(
      stage.caster, stage.image, stage.truth, stage.light, pair, {.phases = phases});
  EXPECT_THAT(judged, IsOk());
  return judged.ok() ? *std::move(judged) : ShadowImage();
}

ShadowImage Drawn(const PlanStage& stage, const ParaboloidPair& pair, int phases) {
  auto judged = JudgeDrawnParaboloids(
      stage.caster, stage.image, stage.truth, stage.light, pair, {.phases = phases});
  EXPECT_THAT(judged, IsOk());
  return judged.ok() ? *std::move(judged) : ShadowImage();
}

ShadowImage Judged(const PlanStage& stage, const PagedMap& pages, int phases) {
  auto judged =
      JudgePages(stage.caster, stage.image, stage.truth, stage.light, pages, {.phases = phases});
  EXPECT_THAT(judged, IsOk());
  return judged.ok() ? *std::move(judged) : ShadowImage();
}

PagedMap PagesOf(const PlanStage& stage, int64_t max_texels, int page_side) {
  const auto readback =
      RenderReadback(stage.caster, stage.image.camera, absl::MakeSpan(&stage.light, 1));
  const auto surfaces = FindSurfaces(readback->View(), 1, SampleOptions());
  auto pages = ClipmapPages(*surfaces, stage.light, max_texels, {.page_side = page_side});
  EXPECT_THAT(pages, IsOk());
  return pages.ok() ? *std::move(pages) : PagedMap();
}

int64_t NumDifferent(const std::vector<Lighting>& a, const std::vector<Lighting>& b) {
  int64_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
  return count;
}

// Verdicts of brute force on every judged pixel, beside the judge's. `verdict_of`: of a receiver.
class Comparison {
 public:
  template <typename VerdictOf>
  void Add(const PlanStage& stage, const ShadowImage& judged, const VerdictOf& verdict_of) {
    for (size_t i = 0; i < stage.truth.size(); ++i) {
      if (!IsJudged(stage.truth[i])) {
        EXPECT_EQ(judged.ideal[i], stage.truth[i]);
        EXPECT_EQ(judged.practical[i], stage.truth[i]);
        continue;
      }
      const Verdict verdict = verdict_of(stage.image.pixels[i]);
      num_skipped_ += verdict.is_known ? 0 : 1;
      if (!verdict.is_known) continue;
      ++num_compared_;
      num_dark_ += verdict.ideal ? 1 : 0;
      EXPECT_EQ(judged.ideal[i] == Lighting::kShadowed, verdict.ideal) << "pixel " << i;
      if (verdict.practical_is_close) continue;
      EXPECT_EQ(judged.practical[i] == Lighting::kShadowed, verdict.practical) << "pixel " << i;
    }
  }

  void ExpectEnough() const {
    std::printf(
        "%d compared, %d of them dark; %d skipped\n", num_compared_, num_dark_, num_skipped_);
    EXPECT_GT(num_compared_, 3000);
    EXPECT_GT(num_dark_, 300);
    EXPECT_LT(num_skipped_, num_compared_ / 3);
  }

 private:
  int num_compared_ = 0, num_dark_ = 0, num_skipped_ = 0;
};

// Of phase 0 of so many.
Eigen::Vector2d FirstMove(int phases) { return Eigen::Vector2d::Constant(phases == 1 ? 0 : -0.25); }

TEST(JudgeParaboloids, IsBruteForceOfTheTexelsThatTheLookUpNames) {
  Comparison comparison;
  for (uint64_t seed = 901; seed < 907; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLamp(random), 48, 36);
    const ParaboloidPair pair = RandomPair(stage.light, random, 20000);
    for (const int phases : {1, 4}) {
      const Eigen::Vector2d move = FirstMove(phases);
      comparison.Add(
          stage, Judged(stage, pair, phases), [&](const SurfacePoint& receiver) -> Verdict {
            const ParaboloidPlace place = pair.At(receiver.position);
            const Eigen::Vector2d moved = place.texel + move;
            if (testing::IsOnATexelsEdge(moved)) return {};
            const TexelRay ray = pair.RayAt({place.half, testing::CentreOfTexelAt(moved) - move});
            return testing::VerdictOf(
                stage.caster.scene(), receiver, {ray.origin, ray.direction.normalized()});
          });
    }
  }
  comparison.ExpectEnough();
}

TEST(JudgePages, IsBruteForceOfTheTexelsThatTheLookUpNames) {
  Comparison comparison;
  int num_levels = 0;
  for (uint64_t seed = 911; seed < 917; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomSun(random), 48, 36);
    const PagedMap pages = PagesOf(stage, 8192, 16);
    num_levels += pages.pages.back().level - pages.pages.front().level + 1;
    // Before all geometry, which is within 40 units of the origin.
    const Eigen::Vector3d start = -100.0 * stage.light.direction.normalized();
    for (const int phases : {1, 4}) {
      const Eigen::Vector2d move = FirstMove(phases);
      comparison.Add(
          stage, Judged(stage, pages, phases), [&](const SurfacePoint& receiver) -> Verdict {
            const PagePlace place = pages.At(receiver.position);
            if (place.page < 0) return {true, false, false, false};
            const Eigen::Vector2d moved = place.texel + move;
            if (testing::IsOnATexelsEdge(moved)) return {};
            const TexelRay ray = pages.RayAt({place.page, testing::CentreOfTexelAt(moved) - move});
            return testing::VerdictOf(
                stage.caster.scene(), receiver, {ray.origin + start, ray.direction});
          });
    }
  }
  comparison.ExpectEnough();
  EXPECT_GT(num_levels, 12);
}

// A level's pages are one map cut up: moved over an edge, receivers ask the page beyond.
TEST(JudgePages, FourPagesOfALevelAreTheMapThatTheyTile) {
  // Of 6912: the two have rays from one formula each, and a pixel may lie on an edge.
  constexpr int64_t kRoundedPixels = 2;
  constexpr int kSide = 64;
  for (uint64_t seed = 921; seed < 926; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomSun(random));
    PagedMap pages;
    pages.page_side = kSide;
    // Texels of half a unit: 32 units either way from the origin.
    constexpr int kLevel = -1;
    pages.pages = {{kLevel, -1, -1}, {kLevel, -1, 0}, {kLevel, 0, -1}, {kLevel, 0, 0}};
    pages.plane_from_world = RayFromWorld(stage.light).topRows<2>();
    pages.direction = stage.light.direction.normalized();
    pages.level_bias = pages.last_level = kLevel;
    Eigen::Matrix3d map_from_ray;
    map_from_ray << 2.0, 0.0, kSide, 0.0, 2.0, kSide, 0.0, 0.0, 1.0;
    const JudgedMap whole = {
        MapFromWorld(map_from_ray, RayFromWorld(stage.light), stage.light, {1.0, 2.0}, 1.0),
        {2 * kSide, 2 * kSide}};
    for (const int phases : {1, 4, 9}) {
      const auto expected = JudgeMatrix(
          stage.caster, stage.image, stage.truth, stage.light, whole, {.phases = phases});
      ASSERT_THAT(expected, IsOk());
      const ShadowImage judged = Judged(stage, pages, phases);
      EXPECT_LE(NumDifferent(judged.ideal, expected->ideal), kRoundedPixels);
      EXPECT_LE(NumDifferent(judged.practical, expected->practical), kRoundedPixels);
      EXPECT_GT(judged.wrong.ideal, 20);
      EXPECT_NEAR(judged.wrong.ideal, expected->wrong.ideal, kRoundedPixels);
      EXPECT_NEAR(judged.wrong.practical, expected->wrong.practical, kRoundedPixels);
      EXPECT_NEAR(
          judged.wrong.practical_weighted, expected->wrong.practical_weighted, kRoundedPixels);
      EXPECT_EQ(judged.wrong.outside, expected->wrong.outside);
    }
  }
}

TEST(JudgePages, ReceiversWithoutAPageAreLitAndCountedAsOutside) {
  int64_t num_outside = 0;
  for (uint64_t seed = 931; seed < 934; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomSun(random));
    PagedMap pages = PagesOf(stage, 8192, 16);
    // All but the coarsest: no level further up holds what these do not.
    const int last_level = pages.pages.back().level;
    while (pages.pages.size() > 1 && pages.pages.back().level == last_level) {
      pages.pages.pop_back();
    }
    const ShadowImage judged = Judged(stage, pages, 1);
    int64_t num_dark_outside = 0;
    for (size_t i = 0; i < stage.truth.size(); ++i) {
      if (!IsJudged(stage.truth[i]) || pages.At(stage.image.pixels[i].position).page >= 0) continue;
      EXPECT_EQ(judged.ideal[i], Lighting::kLit);
      EXPECT_EQ(judged.practical[i], Lighting::kLit);
      num_dark_outside += stage.truth[i] == Lighting::kShadowed ? 1 : 0;
    }
    EXPECT_EQ(judged.wrong.outside, num_dark_outside);
    num_outside += num_dark_outside;
  }
  EXPECT_GT(num_outside, 0);
}

TEST(JudgeParaboloids, ManyTexelsGiveTheTruthAndFewerGiveLessOfIt) {
  // Of 6912, those within a texel of a shadow's edge: 0 ... 14 over 20 seeds.
  constexpr int64_t kPixelsOnEdges = 15;
  for (uint64_t seed = 941; seed < 944; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLamp(random));
    const Eigen::Vector3d normal = random.UnitVector();
    int64_t previous = -1;
    for (const int side : {2048, 128, 32}) {
      const auto pair = MakeParaboloidPair(stage.light, normal, int64_t{2} * side * side);
      const WrongPixels wrong = Judged(stage, *pair, 1).wrong;
      if (side == 2048) {
        EXPECT_LE(wrong.ideal, kPixelsOnEdges);
      }
      EXPECT_GT(wrong.ideal, previous);
      EXPECT_EQ(wrong.outside, 0);
      previous = wrong.ideal;
    }
  }
}

// Of all triangles drawn on the texel the one nearest to the receiver's plane.
Verdict VerdictOfDistances(absl::Span<const double> distances,
                           const SurfacePoint& receiver,
                           const TexelRay& ray) {
  constexpr double kClose = 1e-3;  // units: more than single precision makes of 40 units
  const double slope = receiver.normal.dot(ray.direction);
  if (slope > -1e-2) return {};
  if (distances.empty()) return {true, false, false, false};
  const double wanted = receiver.normal.dot(receiver.position - ray.origin) / slope;
  const auto off = [wanted](double a) { return std::abs(a - wanted); };
  const auto is_nearer = [&](double a, double b) { return off(a) < off(b); };
  const double nearest = *std::min_element(distances.begin(), distances.end(), is_nearer);
  for (const double other : distances) {
    const bool is_other = std::abs(other - nearest) > 0.0;
    if (is_other && std::abs(off(other) - off(nearest)) < kClose) return {};
  }
  const double in_front = wanted - distances[0];
  if (nearest > distances[0] && nearest < distances[0] + kClose) return {};
  return {true, nearest > distances[0], in_front > 0.0, std::abs(in_front) < 0.02};
}

TEST(JudgeDrawnParaboloids, IsBruteForceOverTheDistancesDrawn) {
  Comparison comparison;
  for (uint64_t seed = 981; seed < 987; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLamp(random), 48, 36);
    const ParaboloidPair pair = RandomPair(stage.light, random, 20000);
    const TexelGrid grid = GridOf(pair);
    for (const int phases : {1, 4}) {
      const Eigen::Vector2d move = FirstMove(phases);
      const ParaboloidRaster raster(
          stage.caster.scene(), pair, move, std::vector<uint8_t>(grid.num_texels(), 1), 1);
      comparison.Add(
          stage, Drawn(stage, pair, phases), [&](const SurfacePoint& receiver) -> Verdict {
            const ParaboloidPlace place = pair.At(receiver.position);
            const Eigen::Vector2d moved = place.texel + move;
            if (testing::IsOnATexelsEdge(moved)) return {};
            const TexelRay ray = pair.RayAt({place.half, testing::CentreOfTexelAt(moved) - move});
            return VerdictOfDistances(
                raster.DistancesOf(grid.NumberAt(place.half, moved)), receiver, ray);
          });
    }
  }
  comparison.ExpectEnough();
}

TEST(JudgeDrawnParaboloids, FineCastersGiveWhatIsCastAndCoarseOnesAreBent) {
  // Shares of judged pixels. Casters cut to a quarter of a texel differ at edges alone: 0.007 at
  // most over ten seeds. Whole ones differ by 0 ... 0.5, as the board's edges lie; here by 0.5.
  constexpr double kMostOfFine = 0.01, kLeastOfCoarse = 0.1;
  double fine_share = 0.0, coarse_share = 0.0;
  for (uint64_t seed = 951; seed < 954; ++seed) {
    Random random(seed);
    BoxScene boxes = MakeBoxScene(seed);
    const Light light = Light::Point("lamp", {random.Uniform(-3.0, 3.0), 0.0, 3.0});
    // A board close below it, that the lamp sees wider than a right angle.
    boxes.boxes.push_back({light.position - Eigen::Vector3d(0.3, 0.2, 0.8),
                           {1.5, 1.2, 0.05},
                           random.Uniform(0.0, 3.0)});
    const ParaboloidPair pair = RandomPair(light, random, 2 * 96 * 96);
    const PlanStage coarse(boxes, seed, light, 96, 72, 2);
    const Scene fine_scene =
        testing::Tessellated(coarse.caster.scene(), light.position, pair.size, 0.25);
    const RayCaster fine_caster = testing::Caster(fine_scene);
    const auto fine =
        JudgeDrawnParaboloids(fine_caster, coarse.image, coarse.truth, light, pair, {.phases = 4});
    ASSERT_THAT(fine, IsOk());
    const ShadowImage cast = Judged(coarse, pair, 4);
    const ShadowImage bent = Drawn(coarse, pair, 4);
    const LightingCounts counts = CountLighting(coarse.truth);
    const auto judged = static_cast<double>(counts.lit + counts.shadowed);
    const double fine_differs = NumDifferent(fine->ideal, cast.ideal) / judged;
    const double coarse_differs = NumDifferent(bent.ideal, cast.ideal) / judged;
    std::printf("wrong: cast %d, drawn fine %d, coarse %d of %d; other than cast: %.4f, %.4f\n",
                static_cast<int>(cast.wrong.ideal),
                static_cast<int>(fine->wrong.ideal),
                static_cast<int>(bent.wrong.ideal),
                static_cast<int>(judged),
                fine_differs,
                coarse_differs);
    fine_share = std::max(fine_share, fine_differs);
    coarse_share = std::max(coarse_share, coarse_differs);
  }
  EXPECT_LT(fine_share, kMostOfFine);
  EXPECT_GT(coarse_share, kLeastOfCoarse);
}

TEST(JudgeDrawnParaboloids, AreTheSameOnAnyNumberOfThreads) {
  const auto judged = [](int num_threads) {
    Random random(961);
    const PlanStage stage(961, RandomLamp(random), 96, 72, num_threads);
    return Drawn(stage, RandomPair(stage.light, random, 20000), 4);
  };
  const ShadowImage one = judged(1), three = judged(3);
  EXPECT_EQ(one.ideal, three.ideal);
  EXPECT_EQ(one.practical, three.practical);
  EXPECT_EQ(one.wrong.ideal, three.wrong.ideal);
}

TEST(JudgeParaboloids, RefuseWhatTheyCannotJudge) {
  Random random(971);
  const PlanStage stage(971, Light::Point("lamp", {1.0, 2.0, 3.0}));
  const ParaboloidPair good = RandomPair(stage.light, random, 2000);
  const auto judge =
      [&](const ParaboloidPair& pair, const Light& light, JudgeOptions options = {}) {
        return JudgeParaboloids(stage.caster, stage.image, stage.truth, light, pair, options);
      };
  EXPECT_THAT(judge(good, stage.light), IsOk());
  EXPECT_THAT(judge(good, Light::Point("other", {1.0, 2.0, 3.1})),
              StatusIs(kInvalid, HasSubstr("\"other\": the pair of paraboloids around (1, 2, 3)")));
  EXPECT_THAT(judge(good, Light::Directional("sun", {1.0, 2.0, 3.0})),
              StatusIs(kInvalid, HasSubstr("want a point light")));
  EXPECT_THAT(judge(good, stage.light, {.phases = 3}),
              StatusIs(kInvalid, HasSubstr("phases = 3, want a square")));
  EXPECT_THAT(JudgeParaboloids(stage.caster, stage.image, {}, stage.light, good),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
  EXPECT_THAT(
      JudgeDrawnParaboloids(
          stage.caster, stage.image, stage.truth, stage.light, good, {}, {.rim_texels = -1.0}),
      StatusIs(kInvalid, HasSubstr("rim_texels = -1")));
  ParaboloidPair pair = good;
  pair.normal *= 2.0;
  EXPECT_THAT(judge(pair, stage.light), StatusIs(kInvalid, HasSubstr("want length 1")));
  pair = good;
  pair.size = 0;
  EXPECT_THAT(judge(pair, stage.light), StatusIs(kInvalid, HasSubstr("2 maps of 0x0 texels")));
  pair.size = 1 << 15;
  EXPECT_THAT(judge(pair, stage.light), StatusIs(kInvalid, HasSubstr("32768x32768 texels")));
}

TEST(JudgePages, RefuseWhatTheyCannotJudge) {
  Random random(981);
  const PlanStage stage(981, RandomSun(random));
  const PagedMap good = PagesOf(stage, 8192, 16);
  const auto judge = [&](const PagedMap& pages, const Light& light) {
    return JudgePages(stage.caster, stage.image, stage.truth, light, pages);
  };
  EXPECT_THAT(judge(good, stage.light), IsOk());
  EXPECT_THAT(judge(good, Light::Directional("other", {0.0, 0.1, -1.0})),
              StatusIs(kInvalid, HasSubstr("\"other\": the pages along")));
  EXPECT_THAT(judge(good, Light::Point("lamp", {0.0, 0.1, 1.0})),
              StatusIs(kInvalid, HasSubstr("want a directional light")));
  PagedMap pages = good;
  pages.pages.clear();
  EXPECT_THAT(judge(pages, stage.light), StatusIs(kInvalid, HasSubstr("0 maps")));
}

}  // namespace
}  // namespace lightfit
