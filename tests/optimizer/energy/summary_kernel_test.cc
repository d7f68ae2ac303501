#include "optimizer/energy/summary_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <set>
#include <string>

#include "optimizer/energy/footprint.h"
#include "optimizer/energy/summary.h"
#include "tests/testing/highway_targets.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using internal::AccumulateTensor;
using testing::ForEachTarget;
using testing::Random;
using testing::RandomPatchCase;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr MetricWeights kMetrics[] = {{0.0, 1.0}, {1.0, 0.05}};

// math.md (6) as it stands, one sample after the other.
Matrix6d PlainTensor(const Samples& samples, const MetricWeights& metric) {
  Matrix6d tensor = Matrix6d::Zero();
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const SymmetricVector G = ToSymmetricVector(MetricTensor(sample, metric));
    tensor += sample.weight * ToSymmetricVector(sample.X * sample.X.transpose()) * G.transpose();
  }
  return tensor;
}

void ExpectNearPlainLoop(const Samples& samples, const MetricWeights& metric) {
  const Matrix6d plain = PlainTensor(samples, metric);
  const double difference = (AccumulateTensor(samples, metric) - plain).cwiseAbs().maxCoeff();
  EXPECT_LE(difference, 1e-13 * plain.cwiseAbs().maxCoeff()) << samples.size() << " samples";
}

Samples FirstSamples(Samples samples, size_t count) {
  for (auto* array : {&samples.x,
                      &samples.y,
                      &samples.d,
                      &samples.d_x,
                      &samples.d_y,
                      &samples.weight,
                      &samples.edge_normal_x,
                      &samples.edge_normal_y}) {
    array->resize(count);
  }
  return samples;
}

TEST(AccumulateTensor, EqualsPlainLoopOnEveryTarget) {
  ForEachTarget([](const char*) {
    Random random(121);
    for (const int count : {100, 1000, 1003}) {
      const Samples samples =
          RandomPatchCase(random, random.LogUniform(0.5, 1e4), count).normalized;
      for (const MetricWeights& metric : kMetrics) ExpectNearPlainLoop(samples, metric);
    }
  });
}

TEST(AccumulateTensor, EveryTailSizeEqualsPlainLoopOnEveryTarget) {
  ForEachTarget([](const char*) {
    Random random(122);
    const Samples samples = RandomPatchCase(random, 2.0, 9).normalized;
    for (size_t count = 0; count <= 9; ++count) {
      for (const MetricWeights& metric : kMetrics) {
        ExpectNearPlainLoop(FirstSamples(samples, count), metric);
      }
    }
  });
}

TEST(AccumulateTensor, GivesTheSameBitsOnEveryTarget) {
  for (const int count : {1, 2, 3, 5, 64, 1001}) {
    Random random(123);
    const Samples samples = RandomPatchCase(random, 5.0, std::max(count, 3)).normalized;
    for (const MetricWeights& metric : kMetrics) {
      std::set<std::string> results;
      ForEachTarget([&](const char*) {
        const Matrix6d tensor = AccumulateTensor(FirstSamples(samples, count), metric);
        results.emplace(reinterpret_cast<const char*>(tensor.data()), sizeof(double) * 36);
      });
      EXPECT_EQ(results.size(), 1u) << count << " samples";
    }
  }
}

TEST(AccumulateTensor, IsZeroWithoutSamples) {
  EXPECT_EQ(AccumulateTensor(Samples(), {0.0, 1.0}), Matrix6d::Zero());
  EXPECT_EQ(AccumulateTensor(Samples(), {1.0, 0.05}), Matrix6d::Zero());
}

// A sample whose edge is not known counts whole, as in MetricTensor().
TEST(AccumulateTensor, CountsSamplesWithoutEdgeNormalWhole) {
  Random random(124);
  Samples samples = RandomPatchCase(random, 2.0, 10).normalized;
  std::fill(samples.edge_normal_x.begin(), samples.edge_normal_x.end(), 0.0);
  std::fill(samples.edge_normal_y.begin(), samples.edge_normal_y.end(), 0.0);
  const Matrix6d whole = AccumulateTensor(samples, {0.0, 1.05});
  ExpectNearPlainLoop(samples, {0.0, 1.05});
  const Matrix6d unknown = AccumulateTensor(samples, {1.0, 0.05});
  EXPECT_LE((unknown - whole).norm(), 1e-13 * whole.norm());
}

// Samples without any edge normals, as SelectSamples() leaves them unless asked.
TEST(AccumulateTensor, CountsSamplesWithoutEdgeArraysWhole) {
  Random random(125);
  Samples samples = RandomPatchCase(random, 2.0, 10).normalized;
  samples.edge_normal_x.clear();
  samples.edge_normal_y.clear();
  ExpectNearPlainLoop(samples, {0.0, 1.0});
  ExpectNearPlainLoop(samples, {1.0, 0.05});
}

}  // namespace
}  // namespace lightfit
