// partition/split_cell.h
//
// One cell of a plan cut in two.
// In:   a fitted cell.
// Out:  the two cells whose maps, with the best division of the same texels, have the least energy.
//
// Cuts are lines of the ray plane, planes through the light: directions all around, and quantiles
// of the cell's energy along each. All cuts are rated from sums over bins under the weights that
// the samples have in the cell's own map, which bound what the two maps reach
// (Summary::footprint_sum), around the extreme rays in a fixed number of directions; the best few
// once more with a search for the axis; and the best of these is fitted.
#pragma once

#include <optional>
#include <utility>

#include "partition/cells.h"

namespace lightfit {

// Nothing where no cut leaves two cells that have maps, and once a StopScope says so.
std::optional<std::pair<Cell, Cell>> SplitCell(const CellFitter& fitter, const Cell& cell);

// What a cell adds to the energy of a plan whose texels are divided as they should be.
//   math.md (16): E = (sum of PlanTerm)^(1 + q) S^-q
double PlanTerm(const CellFitter& fitter, double energy);

}  // namespace lightfit
