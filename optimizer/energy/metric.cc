#include "optimizer/energy/metric.h"

namespace lightfit {

bool IsL1(Metric metric) { return metric == Metric::kL1 || metric == Metric::kL1AcrossEdge; }

MetricWeights WeightsOf(Metric metric, double along_edge_share) {
  switch (metric) {
    case Metric::kL2:
    case Metric::kL1:
      return {0.0, 1.0};
    case Metric::kL2AcrossEdge:
    case Metric::kL1AcrossEdge:
      return {1.0, along_edge_share};
  }
  return {};
}

}  // namespace lightfit
