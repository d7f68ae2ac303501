// partition/cell_fit.h
//
// The best map of one cell of a plan, at any number of texels.
// In:   ServedRays, the bins of the cell, SearchOptions.
// Out:  CellMap.
//
// As the fit of one light (optimizer/search/axis_search.h), with an aspect that is free: sums of
// footprints by reweighted squares, rounds of (weigh, search the axis, take the best aspect), the
// best round kept. The margin is a share of the map's extent and not in texels, so that the map
// that a cell gets of a budget is the same map, scaled.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "geometry/polygon.h"
#include "optimizer/search/search_options.h"
#include "partition/served_rays.h"

namespace lightfit {

// What is fitted is rated at this many texels.
inline constexpr double kCellTexels = 1 << 20;

// A map of ServedRays' rays X: (u w, v w, w) = map_from_ray X, texels.
struct CellMap {
  Eigen::Matrix3d map_from_ray = Eigen::Matrix3d::Identity();
  double width = 0.0, height = 0.0;  // texels, not whole: kCellTexels in all

  // Sum of the metric over the cell's samples: k S^-q at S texels, q as in MapShapes::Exponent().
  double energy = 0.0;
};

// The cone of rays that a cell must cover.
struct CellCover {
  Eigen::Matrix3d normalized_from_ray;  // of ServedRays' rays; NormalizeRays()
  Polygon hull;                         // counter-clockwise, the origin inside
};

using Bins = absl::Span<const int>;  // indices in ServedRays::bins

// With a little area where the rays have none. Nothing where the bins cover nothing, or rays all
// around a lamp.
std::optional<CellCover> CoverBins(const ServedRays& rays, Bins bins, const Light& light);

// Weights and sums of squares over samples, under the weights that they have in one map.
struct SampleSums {
  EnergyTensor tensor;         // in ServedRays' rays
  double footprint_sum = 0.0;  // of weight times footprint in the map, floored (WeightsForL1())
};

// Footprints squared along u and along v of one sample in a map, and their sum over a cell's.
struct Extents {
  double along_u = 0.0, along_v = 0.0;
};
class MapExtents {
 public:
  explicit MapExtents(const Eigen::Matrix3d& map_from_ray);
  // In the metric; w <= 0 counts as it stands, squared.
  Extents Of(const RaySample& sample) const;

 private:
  Eigen::Vector3d axis_;
  SymmetricVector outer_u_, outer_v_;
};

class CellFitter {
 public:
  // The arguments must outlive the fitter.
  CellFitter(const ServedRays& rays, const Light& light, const SearchOptions& options);

  // From nothing: searches all axes. Nothing where CoverBins() gives nothing, or no axis can be
  // used, and once a StopScope says so.
  std::optional<CellMap> Fit(Bins bins) const;

  // From a map that is near the best, of this cell before it changed a little: fewer rounds.
  std::optional<CellMap> Refit(Bins bins, const CellMap& start) const;

  // The map of the axis and the aspect of `map`, fitted tightly around the bins once more: of whole
  // texels, with a margin of `guard_texels` on top.
  std::optional<Eigen::Matrix3d> MapOfSize(Bins bins,
                                           const CellMap& map,
                                           MapSize size,
                                           double guard_texels) const;

  // Weights of the samples in a map, times what they stand for: the sums of each bin.
  SampleSums SumsOf(const RayBin& bin, const MapExtents& extents, double floor) const;

  // Mean footprint of the bins' samples in a map, times the share below which none is taken to be.
  double FloorOf(Bins bins, const MapExtents& extents) const;

  // Sum over the bins' samples in the metric, of a map of kCellTexels.
  double EnergyOf(Bins bins, const MapExtents& extents) const;

  bool is_l1() const { return is_l1_; }
  const ServedRays& rays() const { return rays_; }
  const Light& light() const { return light_; }
  const SearchOptions& options() const { return options_; }

 private:
  bool HasSamples(Bins bins) const;
  std::optional<CellMap> MapWithoutSamples(const CellCover& cover) const;
  std::optional<Eigen::Matrix3d> FocusedMap(const CellCover& cover,
                                            MapSize size,
                                            double guard_texels) const;
  std::optional<CellMap> Rounds(Bins bins, const CellMap* start, int num_rounds) const;

  const ServedRays& rays_;
  const Light& light_;
  const SearchOptions& options_;
  bool is_l1_;
};

}  // namespace lightfit
