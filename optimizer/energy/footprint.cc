#include "optimizer/energy/footprint.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/stop.h"

namespace lightfit {

Eigen::Matrix2d Footprint(const Eigen::Matrix3d& map_from_ray, const Sample& sample) {
  const double w = map_from_ray.row(2).dot(sample.X);
  const Eigen::Matrix3d ray_from_map = map_from_ray.inverse();
  return w * sample.D * ray_from_map.leftCols<2>();
}

Eigen::Matrix3d MetricTensor(const Sample& sample, const MetricWeights& weights) {
  const bool edge_known = sample.edge_normal != Eigen::Vector2d::Zero();
  const double whole = edge_known ? weights.whole : weights.whole + weights.across_edge;
  const Eigen::Vector3d across = sample.D.transpose() * sample.edge_normal;
  return whole * sample.D.transpose() * sample.D +
         weights.across_edge * across * across.transpose();
}

double Energy(const Eigen::Matrix3d& map_from_ray,
              const Samples& samples,
              const MetricWeights& weights) {
  return EnergyAndGradient(map_from_ray, samples, weights).energy;
}

EnergyGradient EnergyAndGradient(const Eigen::Matrix3d& map_from_ray,
                                 const Samples& samples,
                                 const MetricWeights& weights) {
  const Eigen::Vector3d p = map_from_ray.row(2);
  const Eigen::Matrix3d R = map_from_ray.inverse();
  EnergyGradient sum;
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    const Sample sample = samples.At(i);
    const Eigen::Matrix3d G = MetricTensor(sample, weights);
    const double w = p.dot(sample.X);
    const Eigen::Vector3d G_r1 = G * R.col(0);
    const Eigen::Vector3d G_r2 = G * R.col(1);
    const double footprint = R.col(0).dot(G_r1) + R.col(1).dot(G_r2);
    sum.energy += sample.weight * w * w * footprint;
    // math.md (4): w grows along X, and [r1 r2] move by -r3 (dp.r1, dp.r2).
    const Eigen::Vector3d from_inverse =
        G_r1.dot(R.col(2)) * R.col(0) + G_r2.dot(R.col(2)) * R.col(1);
    sum.dE_dp += 2.0 * sample.weight * w * (footprint * sample.X - w * from_inverse);
  }
  return sum;
}

FootprintStatistics ComputeFootprintStatistics(const Eigen::Matrix3d& map_from_ray,
                                               const Samples& samples) {
  FootprintStatistics statistics;
  const Eigen::Vector3d p = map_from_ray.row(2);
  const Eigen::Matrix<double, 3, 2> R12 = map_from_ray.inverse().leftCols<2>();
  ScratchVector<double> footprints;
  footprints.reserve(samples.size());
  double sum_squared = 0.0, sum_weight = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (IsStopped(i)) return statistics;
    const Sample sample = samples.At(i);
    const double w = p.dot(sample.X);
    if (!(w > 0.0)) continue;
    const double squared = 0.5 * (w * sample.D * R12).squaredNorm();
    footprints.push_back(std::sqrt(squared));
    sum_squared += sample.weight * squared;
    sum_weight += sample.weight;
  }
  statistics.num_behind = static_cast<int64_t>(samples.size() - footprints.size());
  if (footprints.empty()) return statistics;
  const auto quantile = [&footprints](double share) {
    const size_t rank = static_cast<size_t>(std::lround(share * (footprints.size() - 1)));
    std::nth_element(footprints.begin(), footprints.begin() + rank, footprints.end());
    return footprints[rank];
  };
  statistics.rms = std::sqrt(sum_squared / sum_weight);
  statistics.median = quantile(0.5);
  statistics.p99 = quantile(0.99);
  statistics.worst = *std::max_element(footprints.begin(), footprints.end());
  return statistics;
}

}  // namespace lightfit
