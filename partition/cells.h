// partition/cells.h
//
// The cells of a plan while it is being fitted: which bins each map serves, and the map.
#pragma once

#include "base/scratch.h"
#include "partition/cell_fit.h"

namespace lightfit {

struct Cell {
  ScratchVector<int> bins;  // in ServedRays::bins, ascending
  CellMap map;
};
using Cells = ScratchVector<Cell>;

}  // namespace lightfit
