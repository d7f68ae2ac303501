// partition/divided_maps.h
//
// The maps of a plan's cells with a budget of texels divided among them, and who asks which.
// In:   fitted cells, texels of all maps together.
// Out:  DividedMaps: for a ray the densest map that holds it; the energy of the plan.
//
// Texels are divided so that the sum of the cells' energies is least, math.md (16); no cell gets
// less than a small share, as one without boundary samples still is somebody's map.
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "geometry/ray_maps.h"
#include "partition/cells.h"

namespace lightfit {

class DividedMaps {
 public:
  DividedMaps(const CellFitter& fitter, const Cells& cells, double texels);

  // The map of least q_k among those with w_k > 0 whose rectangle holds the ray, math.md (20), or,
  // with `in_rectangle` false, whether it does or not; -1: none.
  int At(const Eigen::Vector3d& ray, bool in_rectangle = true) const;

  // Likewise of all these rays; -1 where none holds them all. `middle` tells which is the densest.
  int At(const Eigen::Vector3d& middle, const ScratchVector<Eigen::Vector3d>& rays) const;

  // Sum over all samples in the metric, each in the map that it asks; those that no map holds count
  // nothing, as the border answers them.
  double Energy() const;

  double texels(int map) const { return maps_[map].width * maps_[map].height; }

 private:
  const CellFitter& fitter_;
  ScratchVector<RayMap> maps_;
};

// How many texels each cell gets.
ScratchVector<double> DivideTexels(const CellFitter& fitter, const Cells& cells, double texels);

}  // namespace lightfit
