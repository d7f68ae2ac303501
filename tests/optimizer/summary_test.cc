#include "optimizer/summary.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "optimizer/fit.h"
#include "optimizer/receivers.h"
#include "optimizer/summary_kernel.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PatchCase;
using testing::Random;
using testing::RandomMap;
using testing::RandomPatchCase;
using testing::RelativeError;
using testing::StatusIs;

EnergyTensor TensorOf(const Samples& samples) {
  return EnergyTensor(internal::AccumulateTensor(samples, {0.0, 1.0}));
}

TEST(SymmetricVector, RoundTrips) {
  Random random(141);
  const Eigen::Matrix3d turn = random.Rotation();
  const Eigen::Matrix3d symmetric = turn + turn.transpose();
  EXPECT_EQ(FromSymmetricVector(ToSymmetricVector(symmetric)), symmetric);
}

// math.md 4: T' contracts N on (ab), N^-T on (cd); the energy of H' = H N^-1 is that of H.
TEST(EnergyTensor, TransformedLeavesEnergyUnchanged) {
  Random random(142);
  for (int i = 0; i < 300; ++i) {
    const PatchCase patches = RandomPatchCase(random, i % 3 == 0 ? 0.0 : 4.0, 10);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    Eigen::Matrix3d new_from_old = random.Rotation();
    new_from_old.topLeftCorner<2, 2>() += random.Matrix2(10.0);
    if (std::abs(new_from_old.determinant()) < 0.1) continue;
    const EnergyTensor old_tensor = TensorOf(patches.normalized);
    const EnergyTensor new_tensor = old_tensor.Transformed(new_from_old);
    const Eigen::Matrix3d map_from_new = map_from_ray * new_from_old.inverse();
    EXPECT_LE(RelativeError(new_tensor.Energy(map_from_new), old_tensor.Energy(map_from_ray)),
              1e-11);
    // And equals the sum over the samples' own moved rays.
    Samples moved = patches.normalized;
    moved.ray_from_screen = new_from_old * moved.ray_from_screen;
    const Eigen::Matrix<double, 6, 6> expected = TensorOf(moved).entries();
    EXPECT_LE((new_tensor.entries() - expected).norm(), 1e-11 * expected.norm());
  }
}

// math.md 4: E = z1'Q z1 + z2'Q z2 with z_i = p (x) r_i.
TEST(EnergyTensor, AsQuadraticFormIsPositiveSemidefiniteAndGivesTheEnergy) {
  Random random(143);
  for (int i = 0; i < 300; ++i) {
    const PatchCase patches = RandomPatchCase(random, i % 3 == 0 ? 0.0 : 4.0, 3 + i % 20);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const EnergyTensor tensor = TensorOf(patches.normalized);
    const Eigen::Matrix<double, 9, 9> Q = tensor.AsQuadraticForm();
    EXPECT_EQ(Q, Q.transpose());
    const Eigen::Matrix<double, 9, 1> eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>>(Q).eigenvalues();
    EXPECT_GE(eigenvalues(0), -1e-13 * eigenvalues(8));
    const Eigen::Matrix3d R = map_from_ray.inverse();
    double energy = 0.0;
    for (int k = 0; k < 2; ++k) {
      Eigen::Matrix<double, 9, 1> z;
      for (int a = 0; a < 3; ++a) z.segment<3>(3 * a) = map_from_ray(2, a) * R.col(k);
      energy += z.dot(Q * z);
    }
    EXPECT_LE(RelativeError(energy, tensor.Energy(map_from_ray)), 1e-12);
  }
}

TEST(EnergyTensor, AtAxisIsTheWeightedSumOfMetrics) {
  Random random(144);
  for (int i = 0; i < 100; ++i) {
    const PatchCase patches = RandomPatchCase(random, 3.0, 10);
    const Eigen::Vector3d p = RandomMap(random, patches.hull).row(2);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (size_t k = 0; k < patches.normalized.size(); ++k) {
      const Sample sample = patches.normalized.At(k);
      sum += sample.weight * std::pow(p.dot(sample.X), 2) * MetricTensor(sample, {0.0, 1.0});
    }
    EXPECT_LE((TensorOf(patches.normalized).AtAxis(p) - sum).norm(), 1e-12 * sum.norm());
  }
}

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
  const Receivers receivers =
      *FindReceivers(frame.View(), 1u << light.shadow_bit, testing::SquaredFootprints().samples);
  return SelectSamples(receivers, light, cover.normalized_from_ray, /*with_edge_normals=*/false);
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
      const auto merged = MergeSummaries(*a, *b, light);
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
        EXPECT_LE(RelativeError(merged->tensor.Energy(map_from_ray), sum), 1e-11)
            << light.name << ", seed " << seed;
      }
    }
  }
  EXPECT_GE(num_merged, 20);
}

TEST(MergeSummaries, Commutes) {
  const FitOptions options = testing::SquaredFootprints();
  Random random(146);
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TwoFrames shot(seed);
    for (const Light& light : shot.lights) {
      const auto a = Summarize(shot.frames[0].View(), light, options);
      const auto b = Summarize(shot.frames[1].View(), light, options);
      if (!a.ok() || !b.ok()) continue;
      const auto ab = MergeSummaries(*a, *b, light);
      const auto ba = MergeSummaries(*b, *a, light);
      ASSERT_THAT(ab, IsOk());
      ASSERT_THAT(ba, IsOk());
      EXPECT_LE(RelativeError(ab->cover.depth.near, ba->cover.depth.near), 1e-9);
      EXPECT_LE(RelativeError(ab->cover.depth.far, ba->cover.depth.far), 1e-9);
      const Eigen::Matrix3d ba_from_ab =
          ba->cover.normalized_from_ray * ab->cover.normalized_from_ray.inverse();
      for (int k = 0; k < 10; ++k) {
        const Eigen::Matrix3d map_from_ba = RandomMap(random, ba->cover.hull);
        EXPECT_LE(RelativeError(ba->tensor.Energy(map_from_ba),
                                ab->tensor.Energy(map_from_ba * ba_from_ab)),
                  1e-10);
      }
    }
  }
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
        const auto merged = MergeSummaries(*a, *b, light);
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
  EXPECT_THAT(MergeSummaries(*a, *b, sun),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("different metrics")));
}

}  // namespace
}  // namespace lightfit
