// optimizer/energy/summary_kernel.h
//
// The pass over the samples of one light, vectorised with run-time dispatch (Highway).
#pragma once

#include <Eigen/Core>

#include "optimizer/energy/footprint.h"
#include "optimizer/readback/samples.h"

namespace lightfit::internal {

// math.md (6): entries over pairs (0,0), (0,1), (0,2), (1,1), (1,2), (2,2) of rays and of G.
//
// Sums run in four interleaved lanes on every processor, without fused multiply-add, so that the
// same samples give the same bits everywhere. Of no use once a StopScope says so.
Eigen::Matrix<double, 6, 6> AccumulateTensor(const Samples& samples, const MetricWeights& metric);

}  // namespace lightfit::internal
