// optimizer/energy/l1_weights.h
//
// Sums of footprints by sums of squares: the weights of iteratively reweighted least squares.
// In:   Samples, a metric, a map.
// Out:  L1Weights.   math.md 4
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

// The weights under which squares stand for footprints: each sample's weight over its footprint in
// `map_from_ray`, which is never taken to be less than a small share of their mean. The second is
// the weighted sum of the footprints, the third that of what the weights take them to be.
// math.md 4. Of no use once a StopScope says so.
struct L1Weights {
  ScratchVector<double> weights;
  double footprint_sum = 0.0;
  double floored_sum = 0.0;
};
L1Weights WeightsForL1(const Samples& samples,
                       const MetricWeights& metric,
                       const Eigen::Matrix3d& map_from_ray);

}  // namespace lightfit
