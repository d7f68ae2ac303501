// The choice among several fits of one light, against all of them made by hand.
#include "optimizer/choose_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/testing/fit_candidates.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::CandidateOf;
using testing::ChosenOf;
using testing::FitCandidate;
using testing::FitCandidates;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// A random scene in two sizes of one picture. Among its lights is a lamp so low that there may be
// no map of all that it leaves dark, or lights.
struct Pictures {
  std::vector<Light> lights;
  SyntheticReadback coarse, fine;
  std::vector<uint32_t> fine_shadow, fine_lit;
  FineCover cover;

  // `mostly_dark`: but for a round spot, as in a room that a light comes into through a window.
  explicit Pictures(uint64_t seed, bool mostly_dark = false) {
    Random random(seed);
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, 3);
    const double x = random.Uniform(-10.0, 10.0), y = random.Uniform(-10.0, 10.0);
    lights.push_back(Light::Point("low", {x, y, random.Uniform(0.2, 2.0)}, 3));
    coarse = Render(scene, RandomCamera(scene, seed, 96, 64), lights);
    fine = Render(scene, RandomCamera(scene, seed, 288, 192), lights);
    if (mostly_dark) {
      const double spot_x = random.Uniform(0.3, 0.7), spot_y = random.Uniform(0.6, 0.9);
      const double radius = random.Uniform(0.05, 0.3);
      for (SyntheticReadback* image : {&coarse, &fine}) {
        const int width = image->camera.width, height = image->camera.height;
        for (int i = 0; i < width * height; ++i) {
          const int x = i % width, y = i / width;
          const double x_share = (x + 0.5) / width, y_share = (y + 0.5) / height;
          if (std::hypot(x_share - spot_x, y_share - spot_y) > radius) {
            image->shadow_bits[i] = ~uint32_t{0};
          }
        }
      }
    }
    for (size_t i = 0; i < fine.depth.size(); ++i) {
      fine_shadow.push_back(fine.shadow_bits[i] & fine.facing_bits[i]);
      fine_lit.push_back(fine.facing_bits[i] & ~fine.shadow_bits[i]);
    }
    cover.columns = fine.camera.width;
    cover.rows = fine.camera.height;
    cover.nearest = fine.depth;
    cover.shadow_bits = fine_shadow;
    cover.lit_bits = fine_lit;
  }
};

Surfaces SurfacesOf(const Readback& readback, const Light& light, const FitOptions& options) {
  return *FindSurfaces(readback, uint32_t{1} << light.shadow_bit, options.samples);
}

FitOptions Automatic() {
  FitOptions options;
  options.border = BorderChoice::kAutomatic;
  return options;
}

void ExpectSame(const LightMatrix& matrix, const LightMatrix& expected) {
  EXPECT_EQ(matrix.map_from_world, expected.map_from_world);
  EXPECT_EQ(matrix.border, expected.border);
  EXPECT_EQ(matrix.facing, expected.facing);
  EXPECT_EQ(matrix.figures.energy, expected.figures.energy);
  EXPECT_EQ(matrix.figures.samples.used, expected.figures.samples.used);
  EXPECT_EQ(matrix.search.stop_reason, expected.search.stop_reason);
}

// Chooses for a light and compares with the one of the candidates that the thresholds say; returns
// that one, named "none" where neither finds a matrix.
FitCandidate ExpectChoice(const Readback& readback,
                          const Light& light,
                          MapSize map,
                          const FitOptions& options) {
  const std::vector<FitCandidate> candidates = FitCandidates(readback, light, map, options);
  FitCandidate expected = ChosenOf(candidates);
  const auto chosen = FitByForecast(SurfacesOf(readback, light, options), light, map, options);
  EXPECT_EQ(chosen.status(), expected.matrix.status()) << expected.name;
  if (!chosen.ok() || !expected.matrix.ok()) {
    expected.name = "none";
    return expected;
  }
  SCOPED_TRACE(expected.name);
  ExpectSame(*chosen, *expected.matrix);
  EXPECT_TRUE(chosen->figures.wrong_share.has_value());
  EXPECT_EQ(chosen->figures.wrong_share.value_or(-1.0), expected.share);
  return expected;
}

TEST(FitByForecast, TakesTheCandidateThatTheThresholdsSay) {
  std::map<std::string, int> chosen;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const Pictures pictures(seed, /*mostly_dark=*/seed % 2 == 0);
    Random random(300 + seed);
    for (const Light& light : pictures.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      Readback readback = pictures.coarse.ViewWithFacing();
      const int side = 1 << random.Int(5, 10);
      const MapSize map = {side, random.Coin() ? side : 2 * side};
      ++chosen[ExpectChoice(readback, light, map, Automatic()).name];
      readback.fine_cover = &pictures.cover;
      ++chosen[ExpectChoice(readback, light, map, Automatic()).name];
      // A cover that no fit may use still counts in the forecast.
      if (seed % 3 != 0) continue;
      FitOptions coarse = Automatic();
      coarse.use_fine_cover = false;
      ++chosen[ExpectChoice(readback, light, map, coarse).name];
    }
  }
  for (const auto& [name, count] : chosen) std::printf("%s: %d\n", name.c_str(), count);
  for (const char* name : {"lit", "dark", "lit, fine", "dark, fine"}) {
    EXPECT_GE(chosen[name], 1) << name;
  }
  EXPECT_GE(chosen["focused"] + chosen["published"], 1);
}

// FitLight() with BorderChoice::kAutomatic is this choice.
TEST(FitByForecast, IsWhatFitLightDoesWithoutABorder) {
  for (uint64_t seed = 21; seed <= 23; ++seed) {
    const testing::TestScene scene(seed, 3);
    const Readback readback = scene.readback.ViewWithFacing();
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const MapSize map = {128, 128};
      const FitOptions options = Automatic();
      const auto by_light = FitLight(readback, light, map, options);
      const auto by_forecast =
          FitByForecast(SurfacesOf(readback, light, options), light, map, options);
      ASSERT_EQ(by_light.status(), by_forecast.status());
      if (!by_light.ok()) continue;
      ExpectSame(*by_light, *by_forecast);
      EXPECT_EQ(by_light->figures.wrong_share, by_forecast->figures.wrong_share);
    }
  }
}

// Also where it is known of other lights.
TEST(FitByForecast, WithoutTheThirdStateIsTheFitWithALitBorder) {
  int num_fitted = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Pictures pictures(seed);
    for (const Light& light : pictures.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const MapSize map = {128, 64};
      FitOptions lit = Automatic();
      lit.border = BorderChoice::kLit;
      for (const bool others : {false, true}) {
        Readback readback = others ? pictures.coarse.ViewWithFacing() : pictures.coarse.View();
        readback.facing_lights = ~(uint32_t{1} << light.shadow_bit);
        const auto expected = FitLight(readback, light, map, lit);
        const auto chosen =
            FitByForecast(SurfacesOf(readback, light, Automatic()), light, map, Automatic());
        ASSERT_EQ(chosen.status(), expected.status());
        if (!chosen.ok()) continue;
        ExpectSame(*chosen, *expected);
        EXPECT_EQ(chosen->border, Border::kLit);
        EXPECT_EQ(chosen->facing, FacingSource::kGuessed);
        EXPECT_EQ(chosen->search.evaluations, expected->search.evaluations);
        EXPECT_EQ(chosen->figures.footprint.worst, expected->figures.footprint.worst);
        ++num_fitted;
      }
      Readback readback = pictures.coarse.View();
      readback.fine_cover = &pictures.cover;
      ExpectChoice(readback, light, map, Automatic());
    }
  }
  EXPECT_GE(num_fitted, 25);
}

// Small maps, where a focused or a published one is foretold to be better now and then.
TEST(FitByForecast, ObeysWhoAsksForASearch) {
  int num_replaced = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const Pictures pictures(seed, /*mostly_dark=*/seed % 2 == 0);
    Random random(500 + seed);
    const Readback readback = pictures.coarse.ViewWithFacing();
    for (const Light& light : pictures.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const int side = 1 << random.Int(4, 9);
      const MapSize map = {side, side};
      for (const Search search :
           {Search::kFocused, Search::kRotationLineSearch, Search::kRotationLineSearchRefined}) {
        FitOptions options = Automatic();
        options.search = search;
        const FitCandidate chosen = ExpectChoice(readback, light, map, options);
        if (chosen.name == "none") continue;
        EXPECT_TRUE(chosen.name == "lit" || chosen.name == "dark") << chosen.name;
        // What would have replaced it, had nobody asked.
        for (const FitOptions& known :
             {FitOptions::Focused(options), FitOptions::AsPublished(options)}) {
          const FitCandidate peer =
              CandidateOf("peer", 0.9, readback, light, map, known, options.samples);
          num_replaced += peer.matrix.ok() && peer.share < 0.9 * chosen.share ? 1 : 0;
        }
      }
    }
  }
  std::printf("%d would have been replaced\n", num_replaced);
  EXPECT_GE(num_replaced, 1);
}

TEST(FitByForecast, ErrorsAreThoseOfTheLitFitWhereThereIsNoMapAtAll) {
  const Pictures pictures(4);
  const Readback readback = pictures.coarse.ViewWithFacing();
  const Surfaces surfaces = SurfacesOf(readback, pictures.lights[0], {});
  Light wrong = pictures.lights[0];
  wrong.direction.setZero();
  EXPECT_THAT(FitByForecast(surfaces, wrong, {64, 64}, Automatic()),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light \"sun0\"")));
  for (const MapSize map : {MapSize{0, 64}, MapSize{64, -1}}) {
    FitOptions lit;
    const auto expected = FitLight(surfaces, pictures.lights[0], map, lit);
    ASSERT_FALSE(expected.ok());
    EXPECT_EQ(FitByForecast(surfaces, pictures.lights[0], map, Automatic()).status(),
              expected.status());
  }
}

// A lamp among its receivers has no map of all that is dark, but one of a few lit pixels.
TEST(FitByForecast, ADarkBorderHasAMapWhereALitOneHasNone) {
  int num_rescued = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    Pictures pictures(seed);
    const Light& lamp = pictures.lights[3];
    // Dark, all but a spot that the camera looks at.
    const int width = pictures.coarse.camera.width, height = pictures.coarse.camera.height;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = static_cast<size_t>(y) * width + x;
        const bool is_spot = std::abs(x - width / 2) < 6 && std::abs(y - height / 2) < 6;
        pictures.coarse.facing_bits[i] |= 8u;
        pictures.coarse.shadow_bits[i] |= 8u;
        if (is_spot) pictures.coarse.shadow_bits[i] &= ~8u;
      }
    }
    const Readback readback = pictures.coarse.ViewWithFacing();
    SCOPED_TRACE(seed);
    ExpectChoice(readback, lamp, {256, 256}, Automatic());
    FitOptions options;
    const bool has_lit = FitLight(readback, lamp, {256, 256}, options).ok();
    const auto chosen = FitLight(readback, lamp, {256, 256}, Automatic());
    if (has_lit || !chosen.ok()) continue;
    EXPECT_EQ(chosen->border, Border::kDark);
    ++num_rescued;
  }
  EXPECT_GE(num_rescued, 1);
}

TEST(BorderByForecast, KeepsTheCurrentBorderUnlessTheOtherIsBetterByEnough) {
  int num_kept = 0, num_changed = 0, num_between = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Pictures pictures(seed, /*mostly_dark=*/seed % 2 == 0);
    Random random(400 + seed);
    for (const Light& light : pictures.lights) {
      for (const bool is_fine : {false, true}) {
        SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
        Readback readback = pictures.coarse.ViewWithFacing();
        if (is_fine) readback.fine_cover = &pictures.cover;
        const int side = 1 << random.Int(5, 9);
        const MapSize map = {side, side};
        FitOptions options = Automatic();
        options.margin_percent = random.Uniform(0.0, 20.0);
        FitOptions lit_options = options, dark_options = options;
        lit_options.border = BorderChoice::kLit;
        dark_options.border = BorderChoice::kDark;
        const FitCandidate lit =
            CandidateOf("lit", 0.85, readback, light, map, lit_options, options.samples);
        const FitCandidate dark =
            CandidateOf("dark", 0.85, readback, light, map, dark_options, options.samples);
        const Surfaces surfaces = SurfacesOf(readback, light, options);
        Border result[2];
        for (const Border current : {Border::kLit, Border::kDark}) {
          const bool is_lit = current == Border::kLit;
          const FitCandidate& kept = is_lit ? lit : dark;
          const FitCandidate& other = is_lit ? dark : lit;
          const bool changes =
              other.matrix.ok() && (!kept.matrix.ok() || other.share < 0.85 * kept.share);
          const Border expected =
              (current == Border::kDark) != changes ? Border::kDark : Border::kLit;
          EXPECT_EQ(BorderByForecast(surfaces, light, map, options, current), expected)
              << lit.share << " with a lit border, " << dark.share << " with a dark one";
          (changes ? num_changed : num_kept) += 1;
          result[is_lit ? 0 : 1] = expected;
        }
        // Neither is better by enough: what is, stays.
        num_between += result[0] == Border::kLit && result[1] == Border::kDark ? 1 : 0;
        EXPECT_EQ(BorderByForecast(surfaces, light, map, options),
                  BorderByForecast(surfaces, light, map, options, Border::kLit));
      }
    }
  }
  std::printf("%d kept, %d changed, %d where either stays\n", num_kept, num_changed, num_between);
  EXPECT_GE(num_kept, 40);
  EXPECT_GE(num_changed, 20);
  EXPECT_GE(num_between, 1);
}

TEST(BorderByForecast, IsLitWhereNothingIsKnown) {
  const Pictures pictures(2);
  const Light& sun = pictures.lights[0];
  Readback readback = pictures.coarse.View();
  EXPECT_EQ(
      BorderByForecast(SurfacesOf(readback, sun, {}), sun, {64, 64}, Automatic(), Border::kDark),
      Border::kLit);
  readback = pictures.coarse.ViewWithFacing();
  readback.facing_lights = 2u;
  EXPECT_EQ(
      BorderByForecast(SurfacesOf(readback, sun, {}), sun, {64, 64}, Automatic(), Border::kDark),
      Border::kLit);
  readback.facing_lights = 1u;
  Light wrong = sun;
  wrong.direction.setZero();
  EXPECT_EQ(
      BorderByForecast(SurfacesOf(readback, sun, {}), wrong, {64, 64}, Automatic(), Border::kDark),
      Border::kLit);
}

}  // namespace
}  // namespace lightfit
