// partition/plan_sizes.h
//
// The sizes of a plan's maps in whole texels: any, all the same, or those that hardware takes.
// In:   fitted cells, PlanOptions.
// Out:  a size for each cell; never more texels in all than PlanOptions::texels.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/map_size.h"
#include "partition/cells.h"
#include "partition/plan_options.h"

namespace lightfit {

// With PlanOptions::sizes those of least energy in all, each cell's map in its own shape: exact but
// for the weights of the L1 metrics, which stay as they are in the map of free size. Else as
// DivideTexels() divides them, in about the shape of each cell's map. FailedPrecondition where the
// texels are too few for so many of the smallest maps.
absl::StatusOr<ScratchVector<MapSize>> SizesOfCells(const CellFitter& fitter,
                                                    const Cells& cells,
                                                    const PlanOptions& options);

// Of a plan of one map: square.
MapSize SizeOfOneMap(const PlanOptions& options);

}  // namespace lightfit
