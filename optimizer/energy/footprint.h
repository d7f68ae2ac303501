// optimizer/energy/footprint.h
//
// Footprint of one texel at one sample: how far it reaches on the screen, and its sum over samples.
// In:   map_from_ray (H), samples {X, D}.
// Out:  J_screen_map (2x2, pixels per texel), energy, gradient, statistics.
// Role: the per-sample reference that the summary and the gradients are tested against, and what
//       metrics other than L2 use.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/scratch.h"
#include "optimizer/energy/metric.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

// J_screen_map = w D [r1 r2],  w = h3.X,  [r1 r2 r3] = H^-1.   math.md (2)
//
// Properties, each a test of the same name:
//  (1) IsInverseOfProjectionJacobian
//  (2) UnchangedByRayNormalisation
//
// Requires w > 0 and det H != 0.
Eigen::Matrix2d Footprint(const Eigen::Matrix3d& map_from_ray, const Sample& sample);

// G = D'D, or (D'n)(D'n)' with the edge normal n, weighted: 3x3, G X = 0.   math.md 2 and 4.
// A sample whose edge normal is not known counts whole.
Eigen::Matrix3d MetricTensor(const Sample& sample, const MetricWeights& weights);

// Sum over samples of weight w^2 (r1'G r1 + r2'G r2).   math.md (3), Chong & Gortler (6)
//
// All sums over samples are of no use once a StopScope says so (base/stop.h).
double Energy(const Eigen::Matrix3d& map_from_ray,
              const Samples& samples,
              const MetricWeights& weights);

// The same and its gradient over the axis p = h3 with h1, h2 held fixed.   math.md (4)
struct EnergyGradient {
  double energy = 0.0;
  Eigen::Vector3d dE_dp = Eigen::Vector3d::Zero();
};
EnergyGradient EnergyAndGradient(const Eigen::Matrix3d& map_from_ray,
                                 const Samples& samples,
                                 const MetricWeights& weights);

// How far one texel reaches on the screen: sqrt((|dS/du|^2 + |dS/dv|^2) / 2), so that a map that is
// one-to-one with the read-back has footprint 1. Read-back pixels per texel.
struct FootprintStatistics {
  double rms = 0;     // always there: it follows from the energy
  double median = 0;  // the rest are 0 unless FitOptions::compute_statistics
  double p99 = 0;
  double worst = 0;
  int64_t num_behind = 0;  // samples with w <= 0: outside the map, in none of these
};

// sqrt((|dS/du|^2 + |dS/dv|^2) / 2) of every sample: root mean square, median, 99 % and largest,
// over those in front of the map.
FootprintStatistics ComputeFootprintStatistics(const Eigen::Matrix3d& map_from_ray,
                                               const Samples& samples);

// The same over samples that are spread over several maps.
class FootprintSet {
 public:
  // These samples, which ask this map.
  void Add(const Eigen::Matrix3d& map_from_ray, const Samples& samples);

  FootprintStatistics Statistics();

 private:
  ScratchVector<double> footprints_;
  double sum_squared_ = 0.0, sum_weight_ = 0.0;
  int64_t num_behind_ = 0;
};

}  // namespace lightfit
