#include "optimizer/energy/l1_weights.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/stop.h"

namespace lightfit {

namespace {

// Keeps reweighted samples of vanishing footprint from weighing everything: a share of the mean.
constexpr double kReweightingFloor = 0.02;

// Footprints of all samples in the metric: the terms of the L1 energy.
ScratchVector<double> MetricFootprints(const Samples& samples,
                                       const MetricWeights& metric,
                                       const Eigen::Matrix3d& map_from_ray) {
  const Eigen::Matrix<double, 3, 2> r = map_from_ray.inverse().leftCols<2>();
  ScratchVector<double> footprints(samples.size());
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    const Sample sample = samples.At(i);
    const double w = map_from_ray.row(2).dot(sample.X);
    const Eigen::Matrix2d form = r.transpose() * MetricTensor(sample, metric) * r;
    footprints[i] = std::sqrt(w * w * form.trace());
  }
  return footprints;
}

}  // namespace

L1Weights WeightsForL1(const Samples& samples,
                       const MetricWeights& metric,
                       const Eigen::Matrix3d& map_from_ray) {
  const ScratchVector<double> footprints = MetricFootprints(samples, metric, map_from_ray);
  L1Weights result;
  result.weights.reserve(samples.size());
  double total_weight = 0.0;
  for (size_t i = 0; i < footprints.size(); ++i) {
    result.footprint_sum += samples.weight[i] * footprints[i];
    total_weight += samples.weight[i];
  }
  const double floor = kReweightingFloor * result.footprint_sum / total_weight;
  for (size_t i = 0; i < footprints.size(); ++i) {
    const double floored = std::max(footprints[i], floor);
    result.weights.push_back(samples.weight[i] / floored);
    result.floored_sum += samples.weight[i] * floored;
  }
  return result;
}

}  // namespace lightfit
