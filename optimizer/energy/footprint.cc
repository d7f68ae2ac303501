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
  FootprintSet set;
  set.Add(map_from_ray, samples);
  return set.Statistics();
}

void FootprintSet::Add(const Eigen::Matrix3d& map_from_ray, const Samples& samples) {
  const Eigen::Vector3d p = map_from_ray.row(2);
  const Eigen::Matrix<double, 3, 2> R12 = map_from_ray.inverse().leftCols<2>();
  footprints_.reserve(footprints_.size() + samples.size());
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    const Sample sample = samples.At(i);
    const double w = p.dot(sample.X);
    if (!(w > 0.0)) {
      ++num_behind_;
      continue;
    }
    const double squared = 0.5 * (w * sample.D * R12).squaredNorm();
    footprints_.push_back(std::sqrt(squared));
    sum_squared_ += sample.weight * squared;
    sum_weight_ += sample.weight;
  }
}

FootprintStatistics FootprintSet::Statistics() {
  FootprintStatistics statistics;
  statistics.num_behind = num_behind_;
  if (footprints_.empty()) return statistics;
  const auto quantile = [this](double share) {
    const size_t rank = static_cast<size_t>(std::lround(share * (footprints_.size() - 1)));
    std::nth_element(footprints_.begin(), footprints_.begin() + rank, footprints_.end());
    return footprints_[rank];
  };
  statistics.rms = std::sqrt(sum_squared_ / sum_weight_);
  statistics.median = quantile(0.5);
  statistics.p99 = quantile(0.99);
  statistics.worst = *std::max_element(footprints_.begin(), footprints_.end());
  return statistics;
}

}  // namespace lightfit
