// partition/find_cells.h
//
// How the rays of a light are best divided among several maps.
// In:   ServedRays (by a CellFitter), how many maps, texels of all together.
// Out:  fitted cells.   docs/mathematics.md 11
//
// Grown: of all cells the one is cut whose cut lowers the energy of the plan most, until there are
// enough; a plan of more maps refines that of fewer. Then labels and fits in turn: every bin goes
// to the map that its receivers would ask, and the maps are fitted to what they got. That need not
// lower the energy, so the best round is kept.
#pragma once

#include "base/scratch.h"
#include "partition/cells.h"

namespace lightfit {

// Plans of 1, 2, ... max_cells cells, or fewer where no cut is found. None where the rays have no
// single map, and nothing of use once a StopScope says so.
ScratchVector<Cells> GrowCells(const CellFitter& fitter, int max_cells);

// The best round, perhaps of fewer cells.
Cells AlternateCells(const CellFitter& fitter, const Cells& cells, double texels);

}  // namespace lightfit
