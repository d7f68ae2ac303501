#include "partition/divided_maps.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/stop.h"
#include "partition/split_cell.h"

namespace lightfit {

namespace {

constexpr double kLeastShare = 0.01;

}  // namespace

ScratchVector<double> DivideTexels(const CellFitter& fitter, const Cells& cells, double texels) {
  ScratchVector<double> shares;
  double sum = 0.0;
  for (const Cell& cell : cells) {
    shares.push_back(PlanTerm(fitter, cell.map.energy));
    sum += shares.back();
  }
  double raised = 0.0;
  for (double& share : shares) {
    share = std::max(sum > 0.0 ? share / sum : 1.0, kLeastShare);
    raised += share;
  }
  for (double& share : shares) share *= texels / raised;
  return shares;
}

DividedMaps::DividedMaps(const CellFitter& fitter, const Cells& cells, double texels)
    : fitter_(fitter) {
  const ScratchVector<double> divided = DivideTexels(fitter, cells, texels);
  for (size_t k = 0; k < cells.size(); ++k) {
    const CellMap& cell = cells[k].map;
    const double scale = std::sqrt(divided[k] / (cell.width * cell.height));
    Eigen::Matrix3d map_from_ray = cell.map_from_ray;
    map_from_ray.topRows<2>() *= scale;
    maps_.push_back(RayMap(map_from_ray, scale * cell.width, scale * cell.height));
  }
}

int DividedMaps::At(const Eigen::Vector3d& ray, bool in_rectangle) const {
  return DensestAt(maps_, ray, [&](int k) { return !in_rectangle || maps_[k].Holds(ray); });
}

int DividedMaps::At(const Eigen::Vector3d& middle,
                    const ScratchVector<Eigen::Vector3d>& rays) const {
  return DensestAt(maps_, middle, [&](int k) {
    return std::all_of(
        rays.begin(), rays.end(), [&](const Eigen::Vector3d& ray) { return maps_[k].Holds(ray); });
  });
}

double DividedMaps::Energy() const {
  ScratchVector<MapExtents> extents;
  extents.reserve(maps_.size());
  for (const RayMap& map : maps_) extents.push_back(MapExtents(map.map_from_ray));
  double sum = 0.0;
  const ScratchVector<RaySample>& samples = fitter_.rays().samples;
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    const int k = At(samples[i].X);
    if (k < 0) continue;
    const Extents of = extents[k].Of(samples[i]);
    const double squared = of.along_u + of.along_v;
    sum += samples[i].weight * (fitter_.is_l1() ? std::sqrt(squared) : squared);
  }
  return sum;
}

}  // namespace lightfit
