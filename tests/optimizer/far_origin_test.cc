// The same scene in other units and far from the origin: what is fitted, measured and summed is the
// same to what doubles hold. A scene at L times its size has rounding of 1e-16 L in it.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "optimizer/energy/summary_total.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/tracking/tracker.h"
#include "tests/testing/matchers.h"
#include "tests/testing/moved_scene.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::Apart;
using testing::HowFarApart;
using testing::IsOk;
using testing::Move;
using testing::Random;
using testing::RandomMove;
using testing::RelativeError;
using testing::TestScene;

constexpr MapSize kMap = {1024, 1024};

// Of rounding, each with a factor of ten to what 120 lights came to.
double EnergyTolerance(const Move& move) { return 1e-12 + 1e-14 * move.Distance(); }
double TexelTolerance(const Move& move) { return 1e-8 + 2e-11 * move.Distance(); }
// Where energies depend on a frame's best map, by its weights or as the one that is kept: where
// that is flat rounding may lead to another, as good in its frame. Up to 5e-5 were seen.
constexpr double kOtherBest = 1e-3;
double DepthTolerance(const Move& move) { return 1e-11 + 4e-14 * move.Distance(); }

// A matrix of the scene as one of the moved scene.
Eigen::Matrix4d Moved(const Eigen::Matrix4d& map_from_world, const Move& move) {
  return map_from_world * move.MovedFromWorld().inverse();
}

// The square map turned by a quarter of a circle, which is as good.
Eigen::Matrix4d Turned(Eigen::Matrix4d map_from_world) {
  const Eigen::RowVector4d u = map_from_world.row(0);
  map_from_world.row(0) = kMap.height * map_from_world.row(3) - map_from_world.row(1);
  map_from_world.row(1) = u;
  return map_from_world;
}

TEST(FarOrigin, FitsAreTheSameInAnyUnitsAndAtAnyDistance) {
  Random random(141);
  int num_suns = 0, num_lamps = 0;
  for (uint64_t seed = 300; seed < 325; ++seed) {
    const TestScene scene(seed, 3);
    const Move move = RandomMove(random);
    const SyntheticReadback moved = move.Of(scene.readback);
    const std::vector<Light> lights = move.Of(scene.lights);
    const LightMatrices here = FitLights(scene.View(), scene.lights, kMap);
    const LightMatrices there = FitLights(moved.View(), lights, kMap);
    for (size_t i = 0; i < lights.size(); ++i) {
      SCOPED_TRACE(::testing::PrintToString(seed) + " " + lights[i].name);
      ASSERT_EQ(here[i].status().code(), there[i].status().code()) << there[i].status();
      if (!here[i].ok()) continue;
      (lights[i].kind == Light::Kind::kPoint ? num_lamps : num_suns) += 1;
      EXPECT_LT(RelativeError(there[i]->figures.energy, here[i]->figures.energy),
                EnergyTolerance(move));
      Eigen::Matrix4d matrix = here[i]->map_from_world;
      const auto apart = [&] {
        return HowFarApart(scene.View(), matrix, kMap, moved.View(), there[i]->map_from_world);
      };
      Apart most = apart();
      for (int turn = 1; turn < 4 && most.texels > 1.0; ++turn) {
        matrix = Turned(matrix);
        most = apart();
      }
      EXPECT_LT(most.texels, TexelTolerance(move));
      EXPECT_LT(most.depth, DepthTolerance(move));
    }
  }
  EXPECT_GE(num_suns, 20);
  EXPECT_GE(num_lamps, 40);
}

// In units that are no power of two depths are rounded anew, so both scenes are scaled.
TEST(FarOrigin, UnitsOfAnyScaleAreAsGood) {
  Random random(145);
  for (uint64_t seed = 330; seed < 336; ++seed) {
    const TestScene scene(seed, 3);
    Move scaled, move;
    scaled.scale = move.scale = random.LogUniform(1e-3, 1e4);
    move.offset = move.scale * random.LogUniform(1e3, 1e8) * random.UnitVector();
    const SyntheticReadback near = scaled.Of(scene.readback), far = move.Of(scene.readback);
    const LightMatrices here = FitLights(near.View(), scaled.Of(scene.lights), kMap);
    const LightMatrices there = FitLights(far.View(), move.Of(scene.lights), kMap);
    for (size_t i = 0; i < here.size(); ++i) {
      ASSERT_EQ(here[i].status().code(), there[i].status().code());
      if (!here[i].ok()) continue;
      EXPECT_LT(RelativeError(there[i]->figures.energy, here[i]->figures.energy),
                EnergyTolerance(move))
          << scene.lights[i].name;
    }
  }
}

TEST(FarOrigin, AnybodysMatrixHasTheSameFigures) {
  Random random(142);
  int num_measured = 0;
  for (uint64_t seed = 300; seed < 315; ++seed) {
    const TestScene scene(seed, 3);
    const Move move = RandomMove(random);
    const SyntheticReadback moved = move.Of(scene.readback);
    const std::vector<Light> lights = move.Of(scene.lights);
    for (size_t i = 0; i < lights.size(); ++i) {
      SCOPED_TRACE(::testing::PrintToString(seed) + " " + lights[i].name);
      const auto fit = FitLight(scene.View(), scene.lights[i], kMap);
      if (!fit.ok()) continue;
      const auto here = EvaluateMatrix(scene.View(), scene.lights[i], fit->map_from_world, kMap);
      const auto there =
          EvaluateMatrix(moved.View(), lights[i], Moved(fit->map_from_world, move), kMap);
      ASSERT_THAT(here, IsOk());
      ASSERT_THAT(there, IsOk());
      EXPECT_LT(RelativeError(there->energy, here->energy), EnergyTolerance(move));
      EXPECT_NEAR(*there->wrong_share, *here->wrong_share, EnergyTolerance(move));
      EXPECT_EQ(there->footprint.num_behind, here->footprint.num_behind);
      ++num_measured;
    }
  }
  EXPECT_GE(num_measured, 40);
}

// A camera that walks past a scene.
struct Walk {
  std::vector<Light> lights;
  std::vector<SyntheticReadback> frames, moved;

  Walk(uint64_t seed, const Move& move) {
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, 3);
    Camera camera = lightfit::RandomCamera(scene, seed, 80, 60);
    for (int i = 0; i < 6; ++i) {
      frames.push_back(Render(scene, camera, lights));
      moved.push_back(move.Of(frames.back()));
      camera.camera_from_world(0, 3) += 0.15;
    }
  }
};

absl::StatusOr<LightMatrix> FitSum(absl::Span<const SyntheticReadback> frames,
                                   const Light& light,
                                   Metric metric) {
  FitOptions options;
  options.metric = metric;
  std::vector<Summary> summaries;
  for (const SyntheticReadback& frame : frames) {
    absl::StatusOr<Summary> summary = Summarize(frame.View(), light, options);
    if (!summary.ok()) return summary.status();
    summaries.push_back(*std::move(summary));
  }
  const absl::StatusOr<Summary> sum = MergeSummaries(summaries, light);
  if (!sum.ok()) return sum.status();
  return Fit(*sum, light, kMap, options);
}

TEST(FarOrigin, SumsOfFramesGiveTheSameMatrices) {
  Random random(143);
  int num_fitted = 0;
  for (uint64_t seed = 40; seed < 48; ++seed) {
    const Move move = RandomMove(random);
    const Walk walk(seed, move);
    for (const Light& light : walk.lights) {
      SCOPED_TRACE(::testing::PrintToString(seed) + " " + light.name);
      // Squares are summed without weights, and so without any frame's best map.
      for (const Metric metric : {Metric::kL2AcrossEdge, Metric::kL1AcrossEdge}) {
        const auto here = FitSum(walk.frames, light, metric);
        const auto there = FitSum(walk.moved, move.Of(light), metric);
        ASSERT_EQ(here.status().code(), there.status().code()) << there.status();
        if (!here.ok()) continue;
        EXPECT_LT(RelativeError(there->figures.energy, here->figures.energy),
                  IsL1(metric) ? kOtherBest : EnergyTolerance(move));
        ++num_fitted;
      }
    }
  }
  EXPECT_GE(num_fitted, 32);
}

TEST(FarOrigin, TrackedMatricesAreKeptShiftedAndReplacedAlike) {
  Random random(144);
  int num_shifted = 0;
  for (uint64_t seed = 40; seed < 46; ++seed) {
    const Move move = RandomMove(random);
    const Walk walk(seed, move);
    for (const double stability : {0.1, 0.7}) {
      Tracker here(TrackerOptions::ForStability(stability));
      Tracker there(TrackerOptions::ForStability(stability));
      for (size_t frame = 0; frame < walk.frames.size(); ++frame) {
        const auto first = here.Update(walk.frames[frame].View(), walk.lights, kMap);
        const auto second = there.Update(walk.moved[frame].View(), move.Of(walk.lights), kMap);
        for (size_t i = 0; i < first.size(); ++i) {
          SCOPED_TRACE(::testing::PrintToString(seed) + " " + walk.lights[i].name);
          ASSERT_EQ(first[i].status().code(), second[i].status().code());
          if (!first[i].ok()) continue;
          EXPECT_EQ(first[i]->action, second[i]->action);
          EXPECT_LT(
              RelativeError(second[i]->matrix.figures.energy, first[i]->matrix.figures.energy),
              kOtherBest);
          num_shifted += first[i]->action == TrackerAction::kShifted ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GE(num_shifted, 5);
}

}  // namespace
}  // namespace lightfit
