#include "partition/divided_maps.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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
    Map map = {cell.map_from_ray, scale * cell.width, scale * cell.height, {}};
    map.map_from_ray.topRows<2>() *= scale;
    map.coarseness =
        map.map_from_ray.row(2).transpose() / std::cbrt(std::abs(map.map_from_ray.determinant()));
    maps_.push_back(map);
  }
}

bool DividedMaps::Holds(const Map& map, const Eigen::Vector3d& ray) const {
  const Eigen::Vector3d at = map.map_from_ray * ray;
  return at.z() > 0.0 && at.x() >= 0.0 && at.y() >= 0.0 && at.x() < map.width * at.z() &&
         at.y() < map.height * at.z();
}

int DividedMaps::At(const Eigen::Vector3d& ray, bool in_rectangle) const {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < maps_.size(); ++k) {
    const double q = maps_[k].coarseness.dot(ray);
    if (!(q > 0.0 && q < least) || (in_rectangle && !Holds(maps_[k], ray))) continue;
    least = q;
    best = static_cast<int>(k);
  }
  return best;
}

int DividedMaps::At(const Eigen::Vector3d& middle,
                    const ScratchVector<Eigen::Vector3d>& rays) const {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < maps_.size(); ++k) {
    const double q = maps_[k].coarseness.dot(middle);
    if (!(q > 0.0 && q < least)) continue;
    const bool holds_all = std::all_of(
        rays.begin(), rays.end(), [&](const Eigen::Vector3d& ray) { return Holds(maps_[k], ray); });
    if (!holds_all) continue;
    least = q;
    best = static_cast<int>(k);
  }
  return best;
}

double DividedMaps::Energy() const {
  ScratchVector<MapExtents> extents;
  extents.reserve(maps_.size());
  for (const Map& map : maps_) extents.push_back(MapExtents(map.map_from_ray));
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
