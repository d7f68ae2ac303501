#include "optimizer/energy/summary.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "optimizer/energy/summary_kernel.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::PatchCase;
using testing::Random;
using testing::RandomMap;
using testing::RandomPatchCase;
using testing::RelativeError;

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

}  // namespace
}  // namespace lightfit
