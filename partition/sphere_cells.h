// partition/sphere_cells.h
//
// Cells for a lamp whose receivers are all around it, or nearly.
// In:   ServedRays (by a CellFitter), how many cells; or the light's view in a read-back.
// Out:  fitted cells: clusters of directions, spherical k-means.   docs/mathematics.md 11
//       The fewest maps that have all receivers in front, without a plan of them.
//
// Cuts of one cell cannot begin where no single map exists. Clusters are compact, which is what a
// map of a wide cone wants. Several starts, the same on every machine; the one of least energy.
#pragma once

#include "absl/status/statusor.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "partition/cells.h"

namespace lightfit {

// Of so many maps any rays at all have a plan: one for each face of a cube.
inline constexpr int kAlwaysEnoughMaps = 6;

// None where no start gives `num_cells` cells, or fewer, that all have maps: rays on a whole sphere
// need four at least. Of kAlwaysEnoughMaps there always are some, at worst a cube's faces. Of no
// use once a StopScope says so.
Cells ClusterCells(const CellFitter& fitter, int num_cells, double texels);

// `least` or more. Of no use once a StopScope says so.
int NumMapsAround(const CellFitter& fitter, int least);

// 0 unless receivers surround the light, which LightView::cover says. `fit` is what the view was
// made with. CancelledError once a StopScope says so.
absl::StatusOr<int> NumMapsAround(const LightView& view, const FitOptions& fit);

}  // namespace lightfit
