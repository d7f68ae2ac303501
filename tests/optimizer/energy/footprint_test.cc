#include "optimizer/energy/footprint.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "geometry/homography.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::MatrixNear;
using testing::PatchCase;
using testing::Random;
using testing::RandomMap;
using testing::RandomPatchCase;
using testing::RelativeError;

// A directional light every third time, else a point light from inside the scene to 100 sizes away.
PatchCase NextCase(Random& random, int i) {
  return RandomPatchCase(random, i % 3 == 0 ? 0.0 : random.LogUniform(0.5, 100.0), 6);
}

// math.md (1): D T1 = (1, 0), D T2 = (0, 1), D X = 0.
TEST(Sample, DerivativesInvertTheRaysMovementOverTheScreen) {
  Random random(101);
  for (int i = 0; i < 300; ++i) {
    const PatchCase patches = NextCase(random, i);
    for (const Samples* samples : {&patches.raw, &patches.normalized}) {
      for (size_t k = 0; k < samples->size(); ++k) {
        const Sample sample = samples->At(k);
        const Eigen::Matrix<double, 3, 4>& m = samples->ray_from_screen;
        const Eigen::Vector3d T1 = m.col(0) + samples->d_x[k] * m.col(2);
        const Eigen::Vector3d T2 = m.col(1) + samples->d_y[k] * m.col(2);
        // Rounding of the cross products, in units of what was multiplied.
        const double tolerance = 1e-12 * sample.D.norm() * (T1.norm() + T2.norm());
        EXPECT_THAT(Eigen::Vector2d(sample.D * T1), MatrixNear(Eigen::Vector2d(1, 0), tolerance));
        EXPECT_THAT(Eigen::Vector2d(sample.D * T2), MatrixNear(Eigen::Vector2d(0, 1), tolerance));
        EXPECT_LE((sample.D * sample.X).norm(), 1e-12 * sample.D.norm() * sample.X.norm());
      }
    }
  }
}

// The pixel is moved on its plane by +-h, taken to the world and through the 4x4 into the map.
TEST(Footprint, IsInverseOfProjectionJacobian) {
  Random random(102);
  for (int i = 0; i < 300; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Eigen::Matrix4d map_from_world = MapFromWorld(map_from_ray * patches.normalized_from_ray,
                                                        RayFromWorld(patches.light),
                                                        patches.light,
                                                        {1.0, 2.0},
                                                        1.0);
    const Eigen::Matrix4d world_from_screen = patches.camera.WorldFromScreen();
    const Samples& samples = patches.normalized;
    for (size_t k = 0; k < samples.size(); ++k) {
      const auto texel = [&](double dx, double dy) -> Eigen::Vector2d {
        const double d = samples.d[k] + samples.d_x[k] * dx + samples.d_y[k] * dy;
        const Eigen::Vector3d world =
            (world_from_screen * Eigen::Vector4d(samples.x[k] + dx, samples.y[k] + dy, d, 1.0))
                .hnormalized();
        const Eigen::Vector4d map = map_from_world * world.homogeneous();
        return map.head<2>() / map.w();
      };
      constexpr double kStep = 2e-3;  // pixels
      Eigen::Matrix2d J_map_screen;
      J_map_screen.col(0) = (8.0 * (texel(kStep, 0) - texel(-kStep, 0)) -
                             (texel(2 * kStep, 0) - texel(-2 * kStep, 0))) /
                            (12.0 * kStep);
      J_map_screen.col(1) = (8.0 * (texel(0, kStep) - texel(0, -kStep)) -
                             (texel(0, 2 * kStep) - texel(0, -2 * kStep))) /
                            (12.0 * kStep);
      const Eigen::Matrix2d J_screen_map = Footprint(map_from_ray, samples.At(k));
      EXPECT_THAT(Eigen::Matrix2d(J_screen_map * J_map_screen),
                  MatrixNear(Eigen::Matrix2d(Eigen::Matrix2d::Identity()), 1e-6))
          << i;
    }
  }
}

TEST(Footprint, UnchangedByRayNormalisation) {
  Random random(103);
  for (int i = 0; i < 300; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Eigen::Matrix3d map_from_raw = map_from_ray * patches.normalized_from_ray;
    for (size_t k = 0; k < patches.raw.size(); ++k) {
      const Eigen::Matrix2d expected = Footprint(map_from_ray, patches.normalized.At(k));
      EXPECT_THAT(Footprint(map_from_raw, patches.raw.At(k)),
                  MatrixNear(expected, 1e-9 * expected.norm()));
    }
  }
}

// Rays and maps are homogeneous: neither factor matters, though lambda differs over the screen.
TEST(Footprint, UnchangedByScaleOfRayAndMap) {
  Random random(104);
  for (int i = 0; i < 100; ++i) {
    PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Sample sample = patches.normalized.At(0);
    const Eigen::Matrix2d expected = Footprint(map_from_ray, sample);
    patches.normalized.ray_from_screen *= random.LogUniform(1e-6, 1e6);
    const Eigen::Matrix3d scaled_map = random.LogUniform(1e-6, 1e6) * map_from_ray;
    EXPECT_THAT(Footprint(scaled_map, patches.normalized.At(0)),
                MatrixNear(expected, 1e-11 * expected.norm()));
  }
}

// math.md (5): the footprint's area is w^3 / (V det H).
TEST(Footprint, AreaIsProportionalToTheCubeOfW) {
  Random random(105);
  for (int i = 0; i < 100; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    const Samples& samples = patches.normalized;
    const Sample sample = samples.At(0);
    const Eigen::Matrix<double, 3, 4>& m = samples.ray_from_screen;
    const Eigen::Vector3d T1 = m.col(0) + samples.d_x[0] * m.col(2);
    const Eigen::Vector3d T2 = m.col(1) + samples.d_y[0] * m.col(2);
    const double w = map_from_ray.row(2).dot(sample.X);
    const double area = w * w * w / (sample.X.dot(T1.cross(T2)) * map_from_ray.determinant());
    EXPECT_LE(RelativeError(Footprint(map_from_ray, sample).determinant(), area), 1e-9);
  }
}

// math.md (3), Chong & Gortler (6): the sum of squares of the inverse Jacobian.
TEST(Energy, IsWeightedSumOfSquaredFootprints) {
  Random random(106);
  for (int i = 0; i < 100; ++i) {
    const PatchCase patches = NextCase(random, i);
    const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
    double whole = 0.0, across = 0.0;
    for (size_t k = 0; k < patches.normalized.size(); ++k) {
      const Sample sample = patches.normalized.At(k);
      const Eigen::Matrix2d J = Footprint(map_from_ray, sample);
      whole += sample.weight * J.squaredNorm();
      // A sample whose edge is not known counts whole.
      across += sample.weight * (sample.edge_normal.isZero()
                                     ? J.squaredNorm()
                                     : (sample.edge_normal.transpose() * J).squaredNorm());
    }
    EXPECT_LE(RelativeError(Energy(map_from_ray, patches.normalized, {0.0, 1.0}), whole), 1e-12);
    const double edge_aware = Energy(map_from_ray, patches.normalized, {1.0, 0.05});
    EXPECT_LE(RelativeError(edge_aware, across + 0.05 * whole), 1e-12);
  }
}

TEST(MetricTensor, IsPositiveSemidefiniteAndAnnihilatesTheRay) {
  Random random(107);
  for (int i = 0; i < 100; ++i) {
    const PatchCase patches = NextCase(random, i);
    for (size_t k = 0; k < patches.normalized.size(); ++k) {
      const Sample sample = patches.normalized.At(k);
      for (const MetricWeights& weights : {MetricWeights{0.0, 1.0}, MetricWeights{1.0, 0.05}}) {
        const Eigen::Matrix3d G = MetricTensor(sample, weights);
        EXPECT_LE((G * sample.X).norm(), 1e-12 * G.norm() * sample.X.norm());
        const Eigen::Vector3d eigenvalues =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(G).eigenvalues();
        EXPECT_GE(eigenvalues(0), -1e-12 * eigenvalues(2));
      }
    }
  }
}

TEST(WeightsOf, FollowsTheMetric) {
  EXPECT_EQ(WeightsOf(Metric::kL2, 0.05).across_edge, 0.0);
  EXPECT_EQ(WeightsOf(Metric::kL2, 0.05).whole, 1.0);
  EXPECT_EQ(WeightsOf(Metric::kL1, 0.05).across_edge, 0.0);
  EXPECT_EQ(WeightsOf(Metric::kL2AcrossEdge, 0.05).across_edge, 1.0);
  EXPECT_EQ(WeightsOf(Metric::kL1AcrossEdge, 0.25).whole, 0.25);
}

TEST(ComputeFootprintStatistics, MatchesSortedFootprints) {
  Random random(108);
  const PatchCase patches = RandomPatchCase(random, 3.0, 101);
  const Eigen::Matrix3d map_from_ray = RandomMap(random, patches.hull);
  std::vector<double> footprints;
  double sum = 0.0, sum_weight = 0.0;
  for (size_t k = 0; k < patches.normalized.size(); ++k) {
    const Sample sample = patches.normalized.At(k);
    footprints.push_back(std::sqrt(0.5) * Footprint(map_from_ray, sample).norm());
    sum += sample.weight * footprints.back() * footprints.back();
    sum_weight += sample.weight;
  }
  std::sort(footprints.begin(), footprints.end());
  const FootprintStatistics statistics =
      ComputeFootprintStatistics(map_from_ray, patches.normalized);
  EXPECT_LE(RelativeError(statistics.rms, std::sqrt(sum / sum_weight)), 1e-12);
  EXPECT_LE(RelativeError(statistics.median, footprints[50]), 1e-12);
  EXPECT_LE(RelativeError(statistics.p99, footprints[99]), 1e-12);
  EXPECT_LE(RelativeError(statistics.worst, footprints[100]), 1e-12);
}

TEST(ComputeFootprintStatistics, IsZeroWithoutSamples) {
  const FootprintStatistics statistics =
      ComputeFootprintStatistics(Eigen::Matrix3d::Identity(), Samples());
  EXPECT_EQ(statistics.rms, 0.0);
  EXPECT_EQ(statistics.worst, 0.0);
}

}  // namespace
}  // namespace lightfit
