#include "optimizer/energy/summary_total.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <utility>
#include <vector>

#include "geometry/ray_cone.h"
#include "optimizer/energy/summary_kernel.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/matchers.h"
#include "tests/testing/metric_of.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::RandomMap;
using testing::RelativeError;
using testing::StatusIs;

// Two cameras in one scene: what a shot of two frames is.
struct TwoFrames {
  std::vector<Light> lights;
  SyntheticReadback frames[2];

  explicit TwoFrames(uint64_t seed) {
    const BoxScene scene = MakeBoxScene(seed);
    lights = RandomLights(scene, seed, 3);
    for (int i = 0; i < 2; ++i) {
      frames[i] = Render(scene, RandomCamera(scene, 2 * seed + i, 80, 60), lights);
    }
  }
};

// The samples of one frame in the coordinates of any cover.
Samples SamplesIn(const SyntheticReadback& frame, const Light& light, const RayCover& cover) {
  const Surfaces surfaces =
      *FindSurfaces(frame.View(), 1u << light.shadow_bit, testing::SquaredFootprints().samples);
  return SelectSamples(
      surfaces, light, surfaces.options, cover.normalized_from_ray, /*with_edge_normals=*/false);
}

TEST(MergeSummaries, EqualsSummaryOfTheUnion) {
  const FitOptions options = testing::SquaredFootprints();
  Random random(145);
  int num_merged = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const TwoFrames shot(seed);
    for (const Light& light : shot.lights) {
      const auto a = Summarize(shot.frames[0].View(), light, options);
      const auto b = Summarize(shot.frames[1].View(), light, options);
      if (!a.ok() || !b.ok()) continue;
      const auto merged = MergeSummaries({*a, *b}, light);
      ASSERT_THAT(merged, IsOk());
      ++num_merged;
      EXPECT_EQ(merged->counts.used, a->counts.used + b->counts.used);
      EXPECT_EQ(merged->counts.receivers, a->counts.receivers + b->counts.receivers);
      EXPECT_EQ(merged->total_weight, a->total_weight + b->total_weight);
      const Samples samples[] = {SamplesIn(shot.frames[0], light, merged->cover),
                                 SamplesIn(shot.frames[1], light, merged->cover)};
      for (int k = 0; k < 10; ++k) {
        const Eigen::Matrix3d map_from_ray = RandomMap(random, merged->cover.hull);
        const double sum = Energy(map_from_ray, samples[0], merged->metric) +
                           Energy(map_from_ray, samples[1], merged->metric);
        EXPECT_LE(RelativeError(merged->tensor.Energy(map_from_ray), sum), 1e-12)
            << light.name << ", seed " << seed;
      }
    }
  }
  EXPECT_GE(num_merged, 20);
}

// Every ray of either cover lies inside the merged hull.
TEST(MergeSummaries, CoversBoth) {
  for (const FitOptions& options : {FitOptions(), testing::SquaredFootprints()}) {
    int num_fitted = 0;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(seed);
      const TwoFrames shot(seed);
      for (const Light& light : shot.lights) {
        const auto a = Summarize(shot.frames[0].View(), light, options);
        const auto b = Summarize(shot.frames[1].View(), light, options);
        if (!a.ok() || !b.ok()) continue;
        const auto merged = MergeSummaries({*a, *b}, light);
        ASSERT_THAT(merged, IsOk());
        const auto matrix = Fit(*merged, light, {512, 512}, options);
        if (!matrix.ok()) continue;
        testing::ExpectCovers(*matrix, shot.frames[0].View(), light, options.cover);
        testing::ExpectCovers(*matrix, shot.frames[1].View(), light, options.cover);
        ++num_fitted;
      }
    }
    EXPECT_GE(num_fitted, 12);
  }
}

TEST(MergeSummaries, RefusesDifferentMetrics) {
  const TwoFrames shot(1);
  const Light& sun = shot.lights[0];
  FitOptions across;
  across.metric = Metric::kL2AcrossEdge;
  const auto a = Summarize(shot.frames[0].View(), sun, testing::SquaredFootprints());
  const auto b = Summarize(shot.frames[1].View(), sun, across);
  ASSERT_THAT(a, IsOk());
  ASSERT_THAT(b, IsOk());
  EXPECT_THAT(MergeSummaries({*a, *b}, sun),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("different metrics")));
}

// A camera that goes past a scene.
std::vector<SyntheticReadback> WalkPast(const BoxScene& scene,
                                        absl::Span<const Light> lights,
                                        uint64_t seed,
                                        int num_frames) {
  const Camera first = RandomCamera(scene, seed, 64, 48);
  std::vector<SyntheticReadback> frames;
  for (int i = 0; i < num_frames; ++i) {
    Camera camera = first;
    camera.camera_from_world(0, 3) += 0.3 * i;
    frames.push_back(Render(scene, camera, lights));
  }
  return frames;
}

// Adds up totals as they come off a farm: in any order, by twos and threes.
SummaryTotal AddedInRandomGroups(Random& random, std::vector<SummaryTotal> totals) {
  while (totals.size() > 1) {
    const int last = static_cast<int>(totals.size()) - 1;
    std::swap(totals[random.Int(0, last)], totals.back());
    const SummaryTotal taken = totals.back();
    totals.pop_back();
    EXPECT_THAT(AddToTotal(taken, &totals[random.Int(0, last - 1)]), IsOk());
  }
  return totals.front();
}

bool SameBits(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 16) == 0;
}

TEST(SummaryTotal, IsTheSameToTheLastBitInAnyOrderAndGrouping) {
  Random random(146);
  const FitOptions options;
  int num_fitted = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const std::vector<Light> lights = RandomLights(scene, seed, 3);
    const std::vector<SyntheticReadback> frames = WalkPast(scene, lights, seed, 12);
    for (const Light& light : lights) {
      std::vector<SummaryTotal> totals;
      for (const SyntheticReadback& frame : frames) {
        const auto summary = Summarize(frame.View(), light, options);
        if (summary.ok()) totals.push_back(TotalOf(*summary, light));
      }
      if (totals.size() < 6) continue;
      const auto first = SummaryOfTotal(AddedInRandomGroups(random, totals));
      ASSERT_THAT(first, IsOk());
      const auto first_matrix = Fit(*first, light, {1024, 1024}, options);
      for (int k = 0; k < 5; ++k) {
        const auto other = SummaryOfTotal(AddedInRandomGroups(random, totals));
        ASSERT_THAT(other, IsOk());
        EXPECT_EQ(other->tensor.entries(), first->tensor.entries());
        EXPECT_EQ(other->cover.hull, first->cover.hull);
        EXPECT_EQ(other->cover.normalized_from_ray, first->cover.normalized_from_ray);
        EXPECT_EQ(other->cover.depth.near, first->cover.depth.near);
        EXPECT_EQ(other->footprint_sum, first->footprint_sum);
        const auto matrix = Fit(*other, light, {1024, 1024}, options);
        ASSERT_EQ(matrix.ok(), first_matrix.ok());
        if (!matrix.ok()) continue;
        EXPECT_TRUE(SameBits(matrix->map_from_world, first_matrix->map_from_world));
        EXPECT_EQ(matrix->figures.energy, first_matrix->figures.energy);
        ++num_fitted;
      }
    }
  }
  EXPECT_GE(num_fitted, 40);
}

// Light space costs four digits for every tenfold distance of the light; totals have them to spare.
TEST(SummaryTotal, LosesNothingWithDistantLights) {
  Random random(147);
  double worst = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double distance = random.LogUniform(1.0, 1e6);
    const testing::PatchCase patches = testing::RandomPatchCase(random, distance, 30);
    RayCover cover;
    cover.normalized_from_ray = patches.normalized_from_ray;
    cover.hull = patches.hull;
    cover.depth = {1.0, 2.0};
    const Summary summary = SummarizeSamples(patches.normalized, cover, {0.0, 1.0});
    const auto back = MergeSummaries({summary}, patches.light);
    ASSERT_THAT(back, IsOk());
    const Eigen::Matrix3d back_from_normalized =
        back->cover.normalized_from_ray * summary.cover.normalized_from_ray.inverse();
    Samples moved = patches.normalized;
    moved.ray_from_screen = back_from_normalized * moved.ray_from_screen;
    for (int k = 0; k < 5; ++k) {
      const Eigen::Matrix3d map = RandomMap(random, back->cover.hull);
      worst =
          std::max(worst, RelativeError(back->tensor.Energy(map), Energy(map, moved, {0.0, 1.0})));
    }
  }
  std::printf("energy back from light space: within %.2g\n", worst);
  // The change of frame itself, in double, is what limits the comparison: rays far from the light
  // are only told apart to 1e-16 of its distance.
  EXPECT_LE(worst, 1e-8);
}

TEST(SummaryTotal, FramesWithoutShadowHaveNoPartInTheHull) {
  const BoxScene scene = MakeBoxScene(1);
  const Light sun = RandomLight(scene, 1, RandomLightKind::kSun);
  SyntheticReadback frame = Render(scene, RandomCamera(scene, 1, 80, 60), {sun});
  const auto shadowed = Summarize(frame.View(), sun);
  ASSERT_THAT(shadowed, IsOk());
  for (uint32_t& bits : frame.shadow_bits) bits = 0;
  const auto lit = Summarize(frame.View(), sun);
  ASSERT_THAT(lit, IsOk());
  EXPECT_TRUE(lit->cover.nothing_to_cover);
  const auto alone = MergeSummaries({*shadowed}, sun);
  const auto both = MergeSummaries({*lit, *shadowed}, sun);
  ASSERT_THAT(alone, IsOk());
  ASSERT_THAT(both, IsOk());
  EXPECT_EQ(both->cover.hull, alone->cover.hull);
  EXPECT_EQ(both->cover.depth.far, alone->cover.depth.far);
  EXPECT_EQ(both->counts.receivers, 2 * alone->counts.receivers);
  EXPECT_THAT(MergeSummaries({*lit, *lit}, sun),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("none of its 2 frames")));
}

TEST(SummaryTotal, RefusesALightThatMoved) {
  const BoxScene scene = MakeBoxScene(2);
  const Light lamp = RandomLight(scene, 2, RandomLightKind::kNearPoint);
  const SyntheticReadback frame = Render(scene, RandomCamera(scene, 2, 80, 60), {lamp});
  const auto summary = Summarize(frame.View(), lamp);
  ASSERT_THAT(summary, IsOk());
  Light moved = lamp;
  moved.position.x() += 1.0;
  SummaryTotal total = TotalOf(*summary, lamp);
  EXPECT_THAT(AddToTotal(TotalOf(*summary, moved), &total),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("different lights")));
  EXPECT_EQ(total.num_frames, 1);
}

// Two frames that together lie all around the light: no order of adding hides it.
TEST(SummaryTotal, SaysWhenTheFramesSurroundTheLight) {
  const Light lamp = Light::Point("lamp", Eigen::Vector3d::Zero());
  std::vector<SummaryTotal> totals;
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0.1, 0), Eigen::Vector3d(0.1, 0, 1)}) {
    Summary summary;
    summary.cover.hull = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    summary.cover.normalized_from_ray = FrameAlong(axis);
    summary.cover.depth = {1.0, 2.0};
    totals.push_back(TotalOf(summary, lamp));
  }
  Random random(148);
  for (int k = 0; k < 6; ++k) {
    EXPECT_THAT(SummaryOfTotal(AddedInRandomGroups(random, totals)),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("hangs among")));
  }
}

// The weights of the L1 metrics, taken from the map of the round before: energies from the sum
// become the sum of footprints itself, and fall.
TEST(SummarizeInMap, RoundsOverFramesFindTheBestSumOfFootprints) {
  const FitOptions options;
  const MapSize map = {512, 512};
  int num_fitted = 0;
  double gain = 1.0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const std::vector<Light> lights = RandomLights(scene, seed, 2);
    const std::vector<SyntheticReadback> frames = WalkPast(scene, lights, seed, 4);
    for (const Light& light : lights) {
      absl::StatusOr<LightMatrix> best = absl::UnknownError("not fitted");
      double first_sum = 0.0, last_sum = 0.0;
      for (int round = 0; round < 8; ++round) {
        std::vector<Summary> summaries;
        for (const SyntheticReadback& frame : frames) {
          const auto summary =
              round == 0 ? Summarize(frame.View(), light, options)
                         : SummarizeInMap(frame.View(), light, best->map_from_world, options);
          if (summary.ok()) summaries.push_back(*summary);
        }
        if (summaries.size() < frames.size()) break;
        const auto merged = MergeSummaries(summaries, light);
        ASSERT_THAT(merged, IsOk());
        best = Fit(*merged, light, map, options);
        if (!best.ok()) break;
        last_sum = 0.0;
        for (const SyntheticReadback& frame : frames) {
          last_sum += testing::MetricOf(*best, frame.View(), light, options);
        }
        if (round == 0) first_sum = last_sum;
        EXPECT_GE(best->figures.energy, last_sum * (1.0 - 1e-5));
      }
      if (!best.ok() || last_sum == 0.0) continue;
      // After some rounds weights and map agree, and the bound is the sum.
      EXPECT_LE(best->figures.energy, last_sum * 1.01) << light.name << ", seed " << seed;
      EXPECT_LE(last_sum, first_sum * 1.02) << light.name << ", seed " << seed;
      gain = std::min(gain, last_sum / first_sum);
      ++num_fitted;
    }
  }
  EXPECT_GE(num_fitted, 4);
  std::printf("sum of footprints after rounds / before: at best %.4f\n", gain);
}

// A warp may have w <= 0 at lit samples beyond what it covers. They are left out; the frame and
// what must be covered in it are not.
TEST(SummarizeInMap, LeavesOutWhatLiesBehindTheMap) {
  const FitOptions options;
  int num_split = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const testing::TestScene scene(seed, 3);
    for (const Light& light : scene.lights) {
      const auto whole = Summarize(scene.View(), light, options);
      if (!whole.ok() || whole->counts.used < 8) continue;
      // w is 0 across the middle of the normalised rays.
      Eigen::Matrix3d map_from_normalized = Eigen::Matrix3d::Identity();
      map_from_normalized.row(2) = Eigen::RowVector3d(1.0, 0.0, 0.05);
      map_from_normalized.row(0) = Eigen::RowVector3d(0.0, 0.0, 1.0);
      const Eigen::Matrix<double, 3, 4> rows =
          map_from_normalized * whole->cover.normalized_from_ray * RayFromWorld(light);
      Eigen::Matrix4d map_from_world;
      map_from_world << rows.topRows<2>(), Eigen::RowVector4d::UnitX(), rows.row(2);
      const auto front = SummarizeInMap(scene.View(), light, map_from_world, options);
      ASSERT_THAT(front, IsOk());
      EXPECT_EQ(front->cover.hull, whole->cover.hull);
      EXPECT_LE(front->counts.used, whole->counts.used);
      EXPECT_TRUE(front->tensor.entries().allFinite());
      EXPECT_EQ(front->footprint_sum > 0.0, front->counts.used > 0);
      EXPECT_THAT(MergeSummaries({*whole, *front}, light), IsOk());
      num_split += front->counts.used > 0 && front->counts.used < whole->counts.used;
    }
  }
  EXPECT_GE(num_split, 5);
}

}  // namespace
}  // namespace lightfit
