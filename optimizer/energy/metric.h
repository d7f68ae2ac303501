// optimizer/energy/metric.h
//
// What is summed over the samples, and how much each direction on the screen counts in it.
#pragma once

namespace lightfit {

// What is summed over the samples.
enum class Metric {
  kL2,            // squared footprint of a texel: math.md (3), Chong & Gortler (6)
  kL2AcrossEdge,  // squared extent across the shadow's edge, plus a little of kL2: math.md 4
  kL1,            // footprint, by iteratively reweighted kL2
  kL1AcrossEdge   // extent across the shadow's edge, by iteratively reweighted kL2AcrossEdge
};

bool IsL1(Metric metric);

// How much each direction on the screen counts.
struct MetricWeights {
  double across_edge = 0.0;  // of the squared extent across the shadow's edge
  double whole = 1.0;        // of the squared footprint
};

MetricWeights WeightsOf(Metric metric, double along_edge_share);

}  // namespace lightfit
