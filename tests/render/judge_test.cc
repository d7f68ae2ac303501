#include "render/judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "tests/render/judge_stage.h"
#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::Above;
using testing::AddQuad;
using testing::BoxStage;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::kLamp;
using testing::kSun;
using testing::Random;
using testing::Stage;
using testing::StatusIs;

TEST(JudgeMatrix, ManyTexelsGiveTheTruthAndFewerGiveLessOfIt) {
  for (const Light& light : {kSun, kLamp}) {
    const Stage stage = BoxStage(81, light);
    ASSERT_GT(stage.counts.shadowed, 100);
    int64_t previous = -1;
    for (const int size : {4096, 256, 64, 16}) {
      const WrongPixels wrong = stage.Judged({size, size}).wrong;
      // Texels of a centimetre: a pixel or two on an edge.
      if (size == 4096) {
        EXPECT_LE(wrong.ideal, 20) << light.name;
      }
      EXPECT_GT(wrong.ideal, previous) << light.name << " " << size;
      EXPECT_EQ(wrong.outside, 0);
      previous = wrong.ideal;
    }
  }
}

TEST(JudgeMatrix, ALoneTiltedPlaneHasNoAcne) {
  Scene scene;
  AddQuad({-5, -5, -1}, {5, -5, 2}, {5, 5, 4}, {-5, 5, 1}, &scene);
  for (const Light& light : {kSun, kLamp, Light::Directional("low", {1, 0.2, -0.4})}) {
    const Stage stage(scene, Above(), light);
    ASSERT_GT(stage.counts.lit, 1000) << light.name;
    for (const int size : {3, 8, 50}) {
      const WrongPixels wrong = stage.Judged({size, size}).wrong;
      EXPECT_EQ(wrong.ideal, 0) << light.name;
      EXPECT_EQ(wrong.practical, 0) << light.name;
    }
  }
}

TEST(JudgeMatrix, ConvexBoxesAloneHaveNoAcne) {
  Random random(62);
  for (int i = 0; i < 5; ++i) {
    Scene scene;
    const Eigen::Vector3d half_size = Eigen::Vector3d::Constant(1.5) + 0.5 * random.InCube(1.0);
    testing::AddBox({{0, 0, 0}, half_size, random.Uniform(0.0, 3.0)}, &scene);
    for (const Light& light : {kSun, kLamp}) {
      const Stage stage(scene, Above(), light);
      ASSERT_GT(stage.counts.lit, 200);
      for (const int size : {3, 8, 50}) {
        const WrongPixels wrong = stage.Judged({size, size}).wrong;
        EXPECT_EQ(wrong.ideal, 0) << light.name << " " << size;
        EXPECT_EQ(wrong.practical, 0) << light.name << " " << size;
      }
    }
  }
}

// Two planes that meet in the line x = 0, z = 0, at 45 degrees.
Scene TwoPlanes(double side_height) {
  Scene scene;
  AddQuad({0, -3, 0}, {0, 3, 0}, {-3, 3, side_height}, {-3, -3, side_height}, &scene);
  AddQuad({0, -3, 0}, {0, 3, 0}, {3, 3, side_height}, {3, -3, side_height}, &scene);
  return scene;
}

TEST(JudgeMatrix, PracticalBiasAddsFalseShadowInValleysOnly) {
  const Light light = Light::Directional("sun", {0.2, 0.3, -1});
  const Stage valley(TwoPlanes(3.0), Above(), light);
  ASSERT_EQ(valley.counts.shadowed, 0);
  const WrongPixels in_valley = valley.Judged({12, 12}).wrong;
  EXPECT_EQ(in_valley.ideal, 0);
  EXPECT_GT(in_valley.practical, 10);
  EXPECT_GT(in_valley.practical_weighted, 0.3 * in_valley.practical);
  EXPECT_LT(in_valley.practical_weighted, in_valley.practical);

  const Stage roof(TwoPlanes(-3.0), Above(), light);
  ASSERT_EQ(roof.counts.shadowed, 0);
  EXPECT_EQ(roof.Judged({12, 12}).wrong.ideal, 0);
  EXPECT_EQ(roof.Judged({12, 12}).wrong.practical, 0);
}

// The map around all that is seen, moved to the right.
JudgedMap MovedAside(const Stage& stage, double texels, Border border) {
  JudgedMap map = {testing::MapAround(stage.image, stage.light, {64, 64}), {64, 64}, border};
  map.map_from_world.row(0) += texels * map.map_from_world.row(3);
  return map;
}

TEST(JudgeMatrix, ReceiversOutsideTheMapFindItsBorder) {
  const Stage stage = BoxStage(71, kSun);
  ASSERT_GT(stage.counts.shadowed, 100);
  ASSERT_GT(stage.counts.lit, 100);
  const int64_t judged = stage.counts.lit + stage.counts.shadowed;

  const ShadowImage lit = stage.Judged(MovedAside(stage, 1000.0, Border::kLit));
  EXPECT_EQ(lit.wrong.ideal, stage.counts.shadowed);
  EXPECT_EQ(lit.wrong.outside, stage.counts.shadowed);
  EXPECT_EQ(CountLighting(lit.ideal).lit, judged);
  EXPECT_EQ(CountLighting(lit.practical).shadowed, 0);

  const ShadowImage dark = stage.Judged(MovedAside(stage, 1000.0, Border::kDark));
  EXPECT_EQ(dark.wrong.ideal, stage.counts.lit);
  EXPECT_EQ(dark.wrong.practical, stage.counts.lit);
  EXPECT_EQ(dark.wrong.outside, stage.counts.lit);
  EXPECT_EQ(CountLighting(dark.ideal).shadowed, judged);
  EXPECT_EQ(CountLighting(dark.practical).lit, 0);

  // Behind the projection is outside too.
  JudgedMap behind = MovedAside(stage, 0.0, Border::kDark);
  behind.map_from_world = -behind.map_from_world;
  EXPECT_EQ(stage.Judged(behind).wrong.outside, stage.counts.lit);
}

TEST(JudgeMatrix, TheBorderIsForThoseOutsideAlone) {
  const Stage stage = BoxStage(71, kSun);
  const JudgedMap half = MovedAside(stage, 32.0, Border::kLit);
  JudgedMap half_dark = half;
  half_dark.border = Border::kDark;
  const ShadowImage lit = stage.Judged(half), dark = stage.Judged(half_dark);
  int64_t num_outside = 0, lit_outside = 0;
  for (size_t i = 0; i < stage.truth.size(); ++i) {
    if (stage.truth[i] != Lighting::kLit && stage.truth[i] != Lighting::kShadowed) continue;
    const Eigen::Vector4d place =
        half.map_from_world * stage.image.pixels[i].position.homogeneous();
    if (place.x() < 64.0 * place.w()) {
      EXPECT_EQ(dark.ideal[i], lit.ideal[i]) << "pixel " << i;
      EXPECT_EQ(dark.practical[i], lit.practical[i]) << "pixel " << i;
      continue;
    }
    ++num_outside;
    lit_outside += stage.truth[i] == Lighting::kLit;
    EXPECT_EQ(lit.ideal[i], Lighting::kLit);
    EXPECT_EQ(dark.ideal[i], Lighting::kShadowed);
  }
  EXPECT_GT(lit_outside, 100);
  EXPECT_GT(num_outside, lit_outside);
  EXPECT_EQ(dark.wrong.outside, lit_outside);
  EXPECT_EQ(lit.wrong.outside, num_outside - lit_outside);
}

// The definition: every phase is the map of a matrix moved by hand, judged by itself.
TEST(JudgeMatrix, CountsAreTheMeanOverMovedMaps) {
  // Of a mean over phases: a pixel at an edge that one of the two matrices rounds to the other
  // side.
  constexpr double kRoundedPixels = 0.25;
  // Cosines add up in the same order, but for those pixels.
  constexpr double kRoundedCosines = 0.25;
  int64_t num_different = 0;
  for (const uint64_t seed : {611u, 612u, 613u}) {
    Random random(seed);
    for (const Light& light : {kSun, kLamp}) {
      const Stage stage = BoxStage(seed, light);
      const MapSize size = {static_cast<int>(random.LogUniform(20, 200)),
                            static_cast<int>(random.LogUniform(20, 200))};
      JudgedMap map = {testing::MapAround(stage.image, light, size), size};
      // Some of it outside, and warped, so that w is not 1.
      map.map_from_world.row(3) +=
          random.Uniform(0.0, 0.3) / size.width * map.map_from_world.row(0);
      map.map_from_world.row(0) +=
          random.Uniform(-0.3, 0.3) * size.width * map.map_from_world.row(3);
      map.border = random.Uniform(0.0, 1.0) < 0.5 ? Border::kLit : Border::kDark;
      for (const int n : {1, 2, 3, 8}) {
        SCOPED_TRACE(absl::StrCat(light.name, ", ", n, " x ", n, " phases"));
        const ShadowImage judged = stage.Judged(map, n * n);
        double ideal = 0.0, practical = 0.0, weighted = 0.0, outside = 0.0;
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            Eigen::Matrix4d translation = Eigen::Matrix4d::Identity();
            translation(0, 3) = (i + 0.5) / n - 0.5;
            translation(1, 3) = (j + 0.5) / n - 0.5;
            const ShadowImage moved =
                stage.Judged(JudgedMap{translation * map.map_from_world, size, map.border});
            ideal += static_cast<double>(moved.wrong.ideal) / (n * n);
            practical += static_cast<double>(moved.wrong.practical) / (n * n);
            weighted += moved.wrong.practical_weighted / (n * n);
            outside += static_cast<double>(moved.wrong.outside) / (n * n);
            if (i > 0 || j > 0) continue;
            for (size_t pixel = 0; pixel < stage.truth.size(); ++pixel) {
              num_different += judged.ideal[pixel] != moved.ideal[pixel];
              num_different += judged.practical[pixel] != moved.practical[pixel];
            }
          }
        }
        EXPECT_GT(ideal, 10.0);
        EXPECT_GT(outside, 10.0);
        EXPECT_NEAR(static_cast<double>(judged.wrong.ideal), ideal, 0.5 + kRoundedPixels);
        EXPECT_NEAR(static_cast<double>(judged.wrong.practical), practical, 0.5 + kRoundedPixels);
        EXPECT_NEAR(static_cast<double>(judged.wrong.outside), outside, 0.5 + kRoundedPixels);
        EXPECT_NEAR(judged.wrong.practical_weighted, weighted, kRoundedCosines);
      }
    }
  }
  // Of more than a hundred thousand.
  EXPECT_LE(num_different, 5);
}

// What the phases are for: the count of one map jumps about when it is moved by parts of a texel,
// the mean hardly does.
TEST(JudgeMatrix, MorePhasesSpreadLess) {
  const Stage stage = BoxStage(83, kSun);
  const MapSize size = {48, 48};
  const auto spread = [&](int phases) {
    double sum = 0.0, sum_squares = 0.0;
    constexpr int kMoves = 7;
    for (int move = 0; move < kMoves; ++move) {
      JudgedMap map = {testing::MapAround(stage.image, kSun, size), size};
      map.map_from_world.topRows<2>() +=
          Eigen::Vector2d(0.13 * move, 0.29 * move) * map.map_from_world.row(3);
      const auto wrong = static_cast<double>(stage.Judged(map, phases).wrong.ideal);
      sum += wrong;
      sum_squares += wrong * wrong;
    }
    return std::sqrt(sum_squares / kMoves - (sum / kMoves) * (sum / kMoves));
  };
  const double of_one = spread(1), of_four = spread(4), of_sixteen = spread(16);
  std::printf("spread of 1, 4, 16 phases: %.1f, %.1f, %.1f pixels\n", of_one, of_four, of_sixteen);
  EXPECT_LT(of_four, of_one);
  EXPECT_LT(of_sixteen, 0.5 * of_one);
}

TEST(JudgeFirstPhase, HasTheImagesThatJudgeMatrixKeeps) {
  const Stage stage = BoxStage(83, kLamp);
  const MapSize size = {40, 40};
  const JudgedMap map = {testing::MapAround(stage.image, kLamp, size), size, Border::kDark};
  JudgeOptions options;
  options.phases = 4;
  const absl::StatusOr<ShadowImage> first =
      JudgeFirstPhase(stage.caster, stage.image, stage.truth, kLamp, map, options);
  ASSERT_THAT(first, IsOk());
  const ShadowImage all = stage.Judged(map, 4);
  EXPECT_EQ(first->ideal, all.ideal);
  EXPECT_EQ(first->practical, all.practical);
  int64_t num_wrong = 0;
  for (size_t i = 0; i < stage.truth.size(); ++i) num_wrong += first->ideal[i] != stage.truth[i];
  EXPECT_EQ(first->wrong.ideal, num_wrong);
}

TEST(JudgeMatrix, LeavesBackgroundAndSurfacesThatFaceAwayAlone) {
  const Stage stage = BoxStage(83, kSun);
  const ShadowImage judged = stage.Judged({32, 32});
  for (size_t i = 0; i < stage.truth.size(); ++i) {
    if (stage.truth[i] == Lighting::kLit || stage.truth[i] == Lighting::kShadowed) continue;
    EXPECT_EQ(judged.ideal[i], stage.truth[i]);
    EXPECT_EQ(judged.practical[i], stage.truth[i]);
  }
}

TEST(JudgeMatrix, IsTheSameOnAnyNumberOfThreads) {
  const auto judged = [](int num_threads) {
    const Stage stage = BoxStage(67, kSun, num_threads);
    return stage.Judged(JudgedMap{testing::MapAround(stage.image, kSun, {100, 100}), {100, 100}},
                        4);
  };
  const ShadowImage one = judged(1);
  for (const int num_threads : {2, 5}) {
    const ShadowImage other = judged(num_threads);
    EXPECT_EQ(other.wrong.ideal, one.wrong.ideal);
    EXPECT_EQ(other.ideal, one.ideal);
    EXPECT_EQ(other.practical, one.practical);
    EXPECT_EQ(other.wrong.practical_weighted, one.wrong.practical_weighted);
  }
}

TEST(JudgeMatrix, AFarLampIsAsGoodAsTheSunInItsDirection) {
  const Stage sun = BoxStage(83, kSun);
  const Stage lamp = BoxStage(83, Light::Point("far", -1e5 * kSun.direction.normalized()));
  const MapSize size = {128, 128};
  const int64_t wrong_sun = sun.Judged(size).wrong.ideal;
  const int64_t wrong_lamp =
      lamp.Judged(testing::MapAround(lamp.image, lamp.light, size, kSun.direction), size)
          .wrong.ideal;
  EXPECT_NEAR(static_cast<double>(wrong_lamp), static_cast<double>(wrong_sun), 0.3 * wrong_sun);
}

TEST(JudgeMatrix, RefusesWhatItCannotJudge) {
  const Stage stage = BoxStage(69, kSun);
  const MapSize size = {16, 16};
  const Eigen::Matrix4d matrix = testing::MapAround(stage.image, stage.light, size);
  const auto judge = [&](const Light& light, MapSize map_size, const JudgeOptions& options) {
    return JudgeMatrix(stage.caster, stage.image, stage.truth, light, {matrix, map_size}, options);
  };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(judge(kLamp, size, {}), StatusIs(kInvalid, HasSubstr("do not leave the light")));
  EXPECT_THAT(judge(kSun, {0, 16}, {}), StatusIs(kInvalid, HasSubstr("0x16")));
  EXPECT_THAT(judge(kSun, {65536, 65536}, {}), StatusIs(kInvalid, HasSubstr("65536x65536")));
  EXPECT_THAT(judge(kSun, size, {.constant_share = -1.0}),
              StatusIs(kInvalid, HasSubstr("constant_share = -1")));
  EXPECT_THAT(judge(kSun, size, {.constant_share = std::nan("")}),
              StatusIs(kInvalid, HasSubstr("constant_share")));
  for (const int phases : {0, -4, 2, 3, 63, 81}) {
    EXPECT_THAT(
        judge(kSun, size, {.phases = phases}),
        StatusIs(kInvalid, HasSubstr(absl::StrCat("phases = ", phases, ", want a square"))));
  }
  EXPECT_THAT(
      JudgeFirstPhase(stage.caster, stage.image, stage.truth, kSun, {matrix, size}, {.phases = 2}),
      StatusIs(kInvalid, HasSubstr("phases = 2")));
  EXPECT_THAT(JudgeMatrix(stage.caster, stage.image, {}, kSun, {matrix, size}),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
}

}  // namespace
}  // namespace lightfit
