// partition/sphere_cells.h
//
// Cells for a lamp whose receivers are all around it, or nearly.
// In:   ServedRays (by a CellFitter), how many cells.
// Out:  fitted cells: clusters of directions, spherical k-means.   docs/mathematics.md 11
//
// Cuts of one cell cannot begin where no single map exists. Clusters are compact, which is what a
// map of a wide cone wants. Several starts, the same on every machine; the one of least energy.
#pragma once

#include "partition/cells.h"

namespace lightfit {

// None where no start gives `num_cells` cells, or fewer, that all have maps: rays on a whole sphere
// need four at least. Of six there always are some, at worst a cube's faces. Of no use once a
// StopScope says so.
Cells ClusterCells(const CellFitter& fitter, int num_cells, double texels);

}  // namespace lightfit
