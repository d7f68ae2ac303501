// Energy and gradient of the summary, math.md (7) and (8), and sample by sample, (3) and (4),
// against each other and against autodiff, differences and linearisation.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <vector>

#include "optimizer/energy/footprint.h"
#include "optimizer/energy/summary.h"
#include "optimizer/energy/summary_kernel.h"
#include "tests/testing/gradient_check.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::ExpectGradient;
using testing::ExpectLinearisation;
using testing::PatchCase;
using testing::Random;
using testing::RandomMap;
using testing::RandomPatchCase;
using testing::RelativeError;

constexpr int kNumCases = 400;
constexpr MetricWeights kMetrics[] = {{0.0, 1.0}, {1.0, 0.05}};

// A directional light every fourth time, else a point light from inside the scene to 1e6 sizes
// away.
PatchCase NextCase(Random& random, int i) {
  return RandomPatchCase(
      random, i % 4 == 0 ? 0.0 : random.LogUniform(0.3, 1e6), random.Int(1, 40) + 2);
}

// math.md (3) for any scalar type, with [r1 r2] by Cramer's rule and h1, h2 held fixed.
class SampleEnergy {
 public:
  SampleEnergy(const Samples& samples,
               const MetricWeights& metric,
               const Eigen::Matrix3d& map_from_ray)
      : h1_(map_from_ray.row(0)), h2_(map_from_ray.row(1)) {
    for (size_t i = 0; i < samples.size(); ++i) {
      const Sample sample = samples.At(i);
      rays_.push_back(sample.X);
      tensors_.push_back(sample.weight * MetricTensor(sample, metric));
    }
  }

  template <typename T>
  T operator()(const Eigen::Matrix<T, 3, 1>& p) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector h1 = h1_.cast<T>(), h2 = h2_.cast<T>();
    const T determinant = p.dot(h1.cross(h2));
    const Vector r1 = h2.cross(p) / determinant;
    const Vector r2 = p.cross(h1) / determinant;
    T energy(0.0);
    for (size_t i = 0; i < rays_.size(); ++i) {
      const T w = p.dot(rays_[i].cast<T>());
      const Eigen::Matrix<T, 3, 3> G = tensors_[i].cast<T>();
      energy += w * w * (r1.dot(G * r1) + r2.dot(G * r2));
    }
    return energy;
  }

 private:
  Eigen::Vector3d h1_, h2_;
  std::vector<Eigen::Vector3d> rays_;
  std::vector<Eigen::Matrix3d> tensors_;
};

// Steps of the axis p, whose third component is 1: small against the warp of RandomMap().
constexpr double kStep = 1e-4;

TEST(Summary, EnergyMatchesFootprintSum) {
  Random random(111);
  double worst = 0.0;
  for (int i = 0; i < kNumCases; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    for (const MetricWeights& metric : kMetrics) {
      const EnergyTensor tensor(internal::AccumulateTensor(patches.normalized, metric));
      const double reference = Energy(map_from_ray, patches.normalized, metric);
      EXPECT_GT(reference, 0.0);
      const double error = RelativeError(tensor.Energy(map_from_ray), reference);
      EXPECT_LE(error, 1e-12) << i;
      EXPECT_LE(RelativeError(tensor.EnergyAndGradient(map_from_ray).energy, reference), 1e-12);
      worst = std::max(worst, error);
    }
  }
  std::printf("worst relative error %.2g\n", worst);
}

TEST(Summary, GradientMatchesItsReferences) {
  Random random(112);
  double worst_autodiff = 0.0, worst_difference = 0.0;
  for (int i = 0; i < kNumCases; ++i) {
    SCOPED_TRACE(i);
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Eigen::Vector3d p = map_from_ray.row(2);
    for (const MetricWeights& metric : kMetrics) {
      const SampleEnergy energy(patches.normalized, metric, map_from_ray);
      const EnergyTensor tensor(internal::AccumulateTensor(patches.normalized, metric));
      const Eigen::Vector3d gradient = tensor.EnergyAndGradient(map_from_ray).dE_dp;
      const auto errors = ExpectGradient<3>(energy, p, gradient, kStep);
      ExpectLinearisation<3>(energy, p, gradient, Eigen::Vector3d(kStep * random.UnitVector()));
      worst_autodiff = std::max(worst_autodiff, errors.autodiff);
      worst_difference = std::max(worst_difference, errors.difference);
    }
  }
  std::printf("worst: autodiff %.2g, differences %.2g\n", worst_autodiff, worst_difference);
}

TEST(Footprint, GradientMatchesItsReferences) {
  Random random(113);
  for (int i = 0; i < kNumCases; ++i) {
    SCOPED_TRACE(i);
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Eigen::Vector3d p = map_from_ray.row(2);
    for (const MetricWeights& metric : kMetrics) {
      const SampleEnergy energy(patches.normalized, metric, map_from_ray);
      const EnergyGradient gradient = EnergyAndGradient(map_from_ray, patches.normalized, metric);
      EXPECT_LE(RelativeError(gradient.energy, energy(p)), 1e-12);
      ExpectGradient<3>(energy, p, gradient.dE_dp, kStep);
      ExpectLinearisation<3>(
          energy, p, gradient.dE_dp, Eigen::Vector3d(kStep * random.UnitVector()));
    }
  }
}

// The axis's length is free: with h1, h2 fixed the energy goes with its square, so p.g = 2 E.
TEST(Summary, GradientAlongTheAxisIsTwiceTheEnergy) {
  Random random(114);
  for (int i = 0; i < kNumCases; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const EnergyTensor tensor(internal::AccumulateTensor(patches.normalized, kMetrics[0]));
    const EnergyGradient gradient = tensor.EnergyAndGradient(map_from_ray);
    EXPECT_LE(RelativeError(map_from_ray.row(2).dot(gradient.dE_dp), 2.0 * gradient.energy), 1e-11);
  }
}

// In light space the terms of (7) are large against their sum, w and G r alike, the more so the
// further the light: why rays are normalised before anything is summed. The light-space summary
// loses up to rounding times the fourth power of the distance; at 1e4 scene sizes nothing is left.
TEST(Summary, LightSpaceRaysLosePrecisionWithDistance) {
  constexpr double kLossPerDistanceToTheFourth = 1e-15;
  Random random(115);
  std::printf("distance/size  light-space error  normalised error\n");
  std::vector<double> losses;
  for (int decade = 0; decade <= 5; ++decade) {
    const double low = std::pow(10.0, decade);
    double loss = 0.0, worst_normalized = 0.0;
    for (int i = 0; i < 60; ++i) {
      const double distance = random.LogUniform(low, 10.0 * low);
      const PatchCase patches = RandomPatchCase(random, distance, 20);
      const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
      const double reference = Energy(map_from_ray, patches.normalized, kMetrics[0]);
      const EnergyTensor raw(internal::AccumulateTensor(patches.raw, kMetrics[0]));
      const EnergyTensor normalized(internal::AccumulateTensor(patches.normalized, kMetrics[0]));
      const Eigen::Matrix3d map_from_raw = map_from_ray * patches.normalized_from_ray;
      const double error = std::abs(raw.Energy(map_from_raw) - reference) / reference;
      EXPECT_LE(error, kLossPerDistanceToTheFourth * std::pow(10.0 + distance, 4));
      loss = std::max(loss, error);
      worst_normalized =
          std::max(worst_normalized, RelativeError(normalized.Energy(map_from_ray), reference));
    }
    std::printf("1e%d ... 1e%d   %17.1e %17.1e\n", decade, decade + 1, loss, worst_normalized);
    EXPECT_LE(worst_normalized, 1e-11);
    losses.push_back(loss);
  }
  for (int decade = 1; decade <= 3; ++decade) EXPECT_GT(losses[decade], 10.0 * losses[decade - 1]);
}

}  // namespace
}  // namespace lightfit
