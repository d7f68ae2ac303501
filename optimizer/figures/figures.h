// optimizer/figures/figures.h
//
// How good a map is, in the same figures for every map: searched, kept or somebody else's.
// In:   one light's samples, a map of their rays, the metric.
// Out:  Figures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "optimizer/energy/footprint.h"
#include "optimizer/energy/metric.h"
#include "optimizer/readback/sample_counts.h"
#include "optimizer/readback/samples.h"

namespace lightfit {

struct Figures {
  // Sum over the samples in the metric: of squared footprints, (read-back pixels per texel)^2, or
  // of footprints for the L1 metrics.   math.md (3)
  double energy = 0.0;
  FootprintStatistics footprint;  // and how many samples lie behind the map, in no figure
  SampleCounts samples;           // which samples all of this is over

  // Share of the image's pixels whose shadow will be wrong, 0 ... 1 (optimizer/figures/foretell.h).
  // Absent where nobody foretold it.
  std::optional<double> wrong_share;
};

// Energy and footprints of `map_from_ray` at the samples in front of it; all 0 where there are
// none. Of no use once a StopScope says so.
Figures MeasureFigures(const Samples& samples,
                       const Eigen::Matrix3d& map_from_ray,
                       Metric metric,
                       double along_edge_share);

// The same energy, in less time.
double MeasureEnergy(const Samples& samples,
                     const Eigen::Matrix3d& map_from_ray,
                     Metric metric,
                     double along_edge_share);

}  // namespace lightfit
