#include "optimizer/figures/figures.h"

#include "optimizer/energy/l1_weights.h"

namespace lightfit {

Figures MeasureFigures(const Samples& samples,
                       const Eigen::Matrix3d& map_from_ray,
                       Metric metric,
                       double along_edge_share) {
  Figures figures;
  figures.samples = samples.counts;
  figures.footprint = ComputeFootprintStatistics(map_from_ray, samples);
  const MetricWeights weights = WeightsOf(metric, along_edge_share);
  const auto energy_of = [&](const Samples& in_front) {
    return IsL1(metric) ? WeightsForL1(in_front, weights, map_from_ray).footprint_sum
                        : Energy(map_from_ray, in_front, weights);
  };
  const auto num_in_front = static_cast<int64_t>(samples.size()) - figures.footprint.num_behind;
  if (num_in_front == 0) return figures;
  figures.energy = figures.footprint.num_behind == 0
                       ? energy_of(samples)
                       : energy_of(SamplesInFront(samples, map_from_ray.row(2)));
  return figures;
}

}  // namespace lightfit
