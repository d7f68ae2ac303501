#include "partition/tracking/frame_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/stop.h"
#include "optimizer/energy/footprint.h"

namespace lightfit {

namespace {

ScratchVector<MapExtents> ExtentsOf(const KeptMaps& maps) {
  ScratchVector<MapExtents> extents;
  extents.reserve(maps.size());
  for (const KeptMap& map : maps) extents.push_back(MapExtents(map.rays.map_from_ray));
  return extents;
}

}  // namespace

FrameCosts::FrameCosts(const LightView& view,
                       const ServedRays& rays,
                       const KeptMaps& before,
                       const FitOptions& fit,
                       double guard_texels)
    : rays_(rays),
      before_(RayMapsOf(before)),
      is_l1_(IsL1(fit.metric)),
      guard_texels_(guard_texels) {
  const MetricWeights metric = WeightsOf(fit.metric, fit.along_edge_share);
  boundary_.reserve(view.samples.size());
  for (size_t i = 0; i < view.samples.size(); ++i) {
    const Sample sample = view.samples.At(i);
    boundary_.push_back({sample.X, ToSymmetricVector(MetricTensor(sample, metric)), sample.weight});
  }
}

double FrameCosts::FootprintOf(const RaySample& sample, const MapExtents& extents) const {
  const Extents of = extents.Of(sample);
  const double squared = of.along_u + of.along_v;
  return is_l1_ ? std::sqrt(squared) : squared;
}

ScratchVector<double> FrameCosts::EnergiesInstead(const KeptMaps& asked,
                                                  const KeptMaps& instead) const {
  const ScratchVector<RayMap> ray_maps = RayMapsOf(asked);
  const ScratchVector<MapExtents> extents = ExtentsOf(instead);
  ScratchVector<double> energies(asked.size(), 0.0);
  for (size_t i = 0; i < boundary_.size() && !IsStopped(i); ++i) {
    const int k = DensestAt(ray_maps, boundary_[i].X, guard_texels_);
    if (k >= 0) energies[k] += boundary_[i].weight * FootprintOf(boundary_[i], extents[k]);
  }
  return energies;
}

ScratchVector<double> FrameCosts::EnergiesOf(const KeptMaps& maps) const {
  return EnergiesInstead(maps, maps);
}

double FrameCosts::EnergyOf(const KeptMaps& maps) const {
  const ScratchVector<double> energies = EnergiesOf(maps);
  return std::accumulate(energies.begin(), energies.end(), 0.0);
}

FrameCosts::Costs FrameCosts::CostsOf(const KeptMaps& maps) const {
  const ScratchVector<RayMap> ray_maps = RayMapsOf(maps);
  const ScratchVector<MapExtents> extents = ExtentsOf(maps);
  double energy = 0.0, total_weight = 0.0, squares = 0.0;
  for (size_t i = 0; i < rays_.samples.size() && !IsStopped(i); ++i) {
    const RaySample& sample = rays_.samples[i];
    const int k = DensestAt(ray_maps, sample.X, guard_texels_);
    if (k < 0) continue;
    const double footprint = FootprintOf(sample, extents[k]);
    energy += sample.weight * footprint;
    total_weight += sample.weight;
    if (IsRedrawn(maps[k].action) || DensestAt(before_, sample.X, guard_texels_) != k) {
      squares += sample.weight * (is_l1_ ? footprint * footprint : footprint);
    }
  }
  return {energy, is_l1_ ? std::sqrt(total_weight * squares) : squares};
}

double FrameCosts::CostOf(const KeptMaps& maps) const {
  const Costs costs = CostsOf(maps);
  return costs.energy + costs.redrawn;
}

double FrameCosts::PriceOf(const KeptMaps& maps, double most) const {
  const double room = most - EnergyOf(maps);
  return room > 0.0 ? CostsOf(maps).redrawn / room : std::numeric_limits<double>::infinity();
}

}  // namespace lightfit
