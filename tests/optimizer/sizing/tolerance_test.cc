// Promises of tolerances, held against every sample and against smaller maps.
#include "optimizer/sizing/tolerance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/homography.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::StatusIs;
using testing::TestScene;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr Tolerance::Kind kKinds[] = {
    Tolerance::Kind::kRms, Tolerance::Kind::kP99, Tolerance::Kind::kWorst};

// Footprints at the samples in light space, ascending: none of the library's own statistics.
std::vector<double> SortedFootprints(const TestScene& scene,
                                     const Light& light,
                                     const LightMatrix& matrix) {
  const FitOptions options;
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(scene.View(), uint32_t{1} << light.shadow_bit, options.samples);
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(matrix.map_from_world, light);
  EXPECT_TRUE(surfaces.ok() && map_from_ray.ok());
  const Samples samples = SelectSamples(*surfaces,
                                        light,
                                        surfaces->options,
                                        Eigen::Matrix3d::Identity(),
                                        /*with_edge_normals=*/false);
  std::vector<double> footprints;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    if (map_from_ray->row(2).dot(sample.X) <= 0.0) continue;
    const Eigen::Matrix2d J = Footprint(*map_from_ray, sample);
    footprints.push_back(std::sqrt(0.5 * (J.col(0).squaredNorm() + J.col(1).squaredNorm())));
  }
  std::sort(footprints.begin(), footprints.end());
  return footprints;
}

double Rms(const std::vector<double>& footprints) {
  double sum = 0.0;
  for (const double footprint : footprints) sum += footprint * footprint;
  return std::sqrt(sum / static_cast<double>(footprints.size()));
}

double FigureOf(Tolerance::Kind kind, const std::vector<double>& sorted) {
  switch (kind) {
    case Tolerance::Kind::kRms:
      return Rms(sorted);
    case Tolerance::Kind::kP99:
      return sorted[static_cast<size_t>(std::ceil(0.99 * static_cast<double>(sorted.size()))) - 1];
    case Tolerance::Kind::kWorst:
      return sorted.back();
  }
  return 0.0;
}

TEST(MeetTolerance, HoldsAtTheSamplesAndHardlyMoreThanThat) {
  constexpr double kTolerance = 1e-7;  // other normalised rays
  int num_met = 0;
  double most_to_spare = 1.0;
  for (const int seed : {1, 2}) {
    std::printf("[   seed   ] %d\n", seed);
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      for (const Tolerance::Kind kind : kKinds) {
        MapSizeRules rules;
        rules.multiple = 16;
        const Tolerance tolerance = {kind, kind == Tolerance::Kind::kRms ? 0.1 : 0.3, 1.0};
        const absl::StatusOr<ToleranceMap> met =
            MeetTolerance(scene.View(), light, tolerance, rules);
        if (!met.ok()) continue;
        const std::vector<double> footprints = SortedFootprints(scene, light, met->matrix);
        EXPECT_NEAR(met->reached_px / FigureOf(kind, footprints), 1.0, kTolerance);
        if (!met->is_met) continue;
        ++num_met;
        EXPECT_LE(met->reached_px, tolerance.limit_px);
        const int64_t texels = TexelsOf(met->matrix.map);
        if (texels > 300 * 300 && kind == Tolerance::Kind::kRms) {
          most_to_spare = std::min(most_to_spare, met->reached_px / tolerance.limit_px);
        }
        const int64_t num_within =
            std::upper_bound(
                footprints.begin(), footprints.end(), tolerance.limit_px * (1.0 + kTolerance)) -
            footprints.begin();
        const auto count = static_cast<double>(footprints.size());
        const double share = kind == Tolerance::Kind::kRms   ? 0.0
                             : kind == Tolerance::Kind::kP99 ? 0.99
                                                             : 1.0;
        EXPECT_GE(num_within, share * count);
        EXPECT_TRUE(met->matrix.map_from_world.allFinite());
      }
    }
  }
  std::printf("rms reached / asked for, least: %.4f\n", most_to_spare);
  EXPECT_GT(num_met, 8);
  EXPECT_GT(most_to_spare, 0.95);
}

// The twin: every size of a coarse set, fitted and measured.
TEST(MeetTolerance, NoSmallerMapOfAllSizesHolds) {
  MapSizeRules rules;
  rules.multiple = rules.min_side = 64;
  rules.max_side = 960;
  int num_compared = 0;
  for (const int seed : {1, 2, 3}) {
    std::printf("[   seed   ] %d\n", seed);
    const TestScene scene(seed, 2);
    for (const Light& light : scene.lights) {
      const Tolerance tolerance = {Tolerance::Kind::kRms, 0.3, 1.0};
      const absl::StatusOr<ToleranceMap> met = MeetTolerance(scene.View(), light, tolerance, rules);
      if (!met.ok() || !met->is_met) continue;
      FitOptions options;
      options.metric = Metric::kL2;
      const absl::StatusOr<Summary> summary = Summarize(scene.View(), light, options);
      ASSERT_TRUE(summary.ok()) << summary.status();
      int64_t least = TexelsOf(met->matrix.map);
      for (int width = 64; width <= 960; width += 64) {
        for (int height = 64; height <= width; height += 64) {
          const MapSize map = {width, height};
          if (TexelsOf(map) >= least) continue;
          const absl::StatusOr<LightMatrix> fit = FitMatrix({light, *summary}, map, options);
          if (fit.ok() && fit->figures.footprint.rms <= tolerance.limit_px) least = TexelsOf(map);
        }
      }
      EXPECT_EQ(TexelsOf(met->matrix.map), least) << light.name;
      ++num_compared;
    }
  }
  EXPECT_GE(num_compared, 3);
}

TEST(MeetTolerance, ReweightingBeatsSquaresWhereFewSamplesDecide) {
  int num_compared = 0;
  double log_sum = 0.0;
  for (const int seed : {1, 2}) {
    std::printf("[   seed   ] %d\n", seed);
    const TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      FitOptions squares;
      squares.metric = Metric::kL2;
      for (const Tolerance::Kind kind : {Tolerance::Kind::kP99, Tolerance::Kind::kWorst}) {
        const absl::StatusOr<ToleranceMap> met =
            MeetTolerance(scene.View(), light, {kind, 0.5, 1.0}, MapSizeRules());
        if (!met.ok() || !met->is_met) continue;
        const absl::StatusOr<LightMatrix> fit =
            FitLight(scene.View(), light, met->matrix.map, squares);
        ASSERT_TRUE(fit.ok()) << fit.status();
        const double plain = FigureOf(kind, SortedFootprints(scene, light, *fit));
        log_sum += std::log(met->reached_px / plain);
        ++num_compared;
      }
    }
  }
  ASSERT_GT(num_compared, 3);
  const double ratio = std::exp(log_sum / num_compared);
  std::printf("footprint of the deciding sample / that under plain squares: %.3f\n", ratio);
  EXPECT_LT(ratio, 0.95);
}

TEST(MeetTolerance, CountsPixelsOfTheFinalImage) {
  const TestScene scene(1, 1);
  const absl::StatusOr<ToleranceMap> readback_pixels = MeetTolerance(
      scene.View(), scene.lights[0], {Tolerance::Kind::kRms, 0.25, 1.0}, MapSizeRules());
  const absl::StatusOr<ToleranceMap> image_pixels = MeetTolerance(
      scene.View(), scene.lights[0], {Tolerance::Kind::kRms, 1.0, 4.0}, MapSizeRules());
  ASSERT_TRUE(readback_pixels.ok() && image_pixels.ok());
  EXPECT_EQ(readback_pixels->matrix.map_from_world, image_pixels->matrix.map_from_world);
  EXPECT_EQ(4.0 * readback_pixels->reached_px, image_pixels->reached_px);
}

TEST(MeetTolerance, GivesTheBestOfTheLargestMapWhereItCannotBeMet) {
  const TestScene scene(1, 1);
  MapSizeRules rules;
  rules.max_side = 256;
  const absl::StatusOr<ToleranceMap> met =
      MeetTolerance(scene.View(), scene.lights[0], {Tolerance::Kind::kRms, 1e-4, 1.0}, rules);
  ASSERT_TRUE(met.ok()) << met.status();
  EXPECT_FALSE(met->is_met);
  EXPECT_GT(met->reached_px, 1e-4);
  EXPECT_EQ(TexelsOf(met->matrix.map), 256 * 256);
  EXPECT_GT(met->num_samples, 0);
}

TEST(MeetTolerance, SummaryServesTheRootMeanSquareAlone) {
  const TestScene scene(2, 1);
  const Light& light = scene.lights[0];
  FitOptions options;
  options.metric = Metric::kL2;
  const absl::StatusOr<Summary> summary = Summarize(scene.View(), light, options);
  ASSERT_TRUE(summary.ok()) << summary.status();
  const Tolerance rms = {Tolerance::Kind::kRms, 0.2, 1.0};
  const absl::StatusOr<ToleranceMap> from_summary =
      MeetTolerance(*summary, light, rms, MapSizeRules(), options);
  const absl::StatusOr<ToleranceMap> from_readback =
      MeetTolerance(scene.View(), light, rms, MapSizeRules(), options);
  ASSERT_TRUE(from_summary.ok() && from_readback.ok());
  EXPECT_EQ(from_summary->matrix.map_from_world, from_readback->matrix.map_from_world);
  EXPECT_NEAR(from_summary->reached_px / from_readback->reached_px, 1.0, 1e-9);

  const Tolerance p99 = {Tolerance::Kind::kP99, 0.2, 1.0};
  EXPECT_THAT(MeetTolerance(*summary, light, p99, MapSizeRules(), options),
              StatusIs(kInvalid, HasSubstr("give the read-back")));
  EXPECT_THAT(MeetTolerance(*summary, light, rms, MapSizeRules()),
              StatusIs(kInvalid, HasSubstr("squared footprints")));
}

TEST(MeetTolerance, SaysWhatIsWrong) {
  TestScene scene(1, 1);
  const Light& light = scene.lights[0];
  const MapSizeRules rules;
  EXPECT_THAT(MeetTolerance(scene.View(), light, {Tolerance::Kind::kRms, 0.0, 1.0}, rules),
              StatusIs(kInvalid, HasSubstr("tolerance.limit_px = 0, want a number above 0")));
  EXPECT_THAT(MeetTolerance(scene.View(), light, {Tolerance::Kind::kRms, 1.0, -2.0}, rules),
              StatusIs(kInvalid, HasSubstr("tolerance.image_scale = -2")));
  scene.readback.shadow_bits.assign(scene.readback.shadow_bits.size(), 0);
  for (const Tolerance::Kind kind : kKinds) {
    EXPECT_THAT(MeetTolerance(scene.View(), light, {kind, 1.0, 1.0}, rules),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("no shadow boundary")));
  }
}

}  // namespace
}  // namespace lightfit
