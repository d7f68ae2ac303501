#include "optimizer/figures/figures.h"

#include "base/stop.h"
#include "optimizer/energy/l1_weights.h"

namespace lightfit {

namespace {

int64_t CountBehind(const Samples& samples, const Eigen::RowVector3d& axis) {
  int64_t num_behind = 0;
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    num_behind += axis.dot(samples.At(i).X) > 0.0 ? 0 : 1;
  }
  return num_behind;
}

double EnergyInFront(const Samples& samples,
                     int64_t num_behind,
                     const Eigen::Matrix3d& map_from_ray,
                     Metric metric,
                     double along_edge_share) {
  const MetricWeights weights = WeightsOf(metric, along_edge_share);
  const auto energy_of = [&](const Samples& in_front) {
    return IsL1(metric) ? WeightsForL1(in_front, weights, map_from_ray).footprint_sum
                        : Energy(map_from_ray, in_front, weights);
  };
  if (num_behind == static_cast<int64_t>(samples.size())) return 0.0;
  return num_behind == 0 ? energy_of(samples)
                         : energy_of(SamplesInFront(samples, map_from_ray.row(2)));
}

}  // namespace

Figures MeasureFigures(const Samples& samples,
                       const Eigen::Matrix3d& map_from_ray,
                       Metric metric,
                       double along_edge_share) {
  Figures figures;
  figures.samples = samples.counts;
  figures.footprint = ComputeFootprintStatistics(map_from_ray, samples);
  figures.energy =
      EnergyInFront(samples, figures.footprint.num_behind, map_from_ray, metric, along_edge_share);
  return figures;
}

double MeasureEnergy(const Samples& samples,
                     const Eigen::Matrix3d& map_from_ray,
                     Metric metric,
                     double along_edge_share) {
  return EnergyInFront(
      samples, CountBehind(samples, map_from_ray.row(2)), map_from_ray, metric, along_edge_share);
}

}  // namespace lightfit
