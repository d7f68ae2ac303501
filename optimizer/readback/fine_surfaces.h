// optimizer/readback/fine_surfaces.h
//
// What the finer cover adds to what one light's maps must have room for.
// In:   Surfaces of a read-back with a FineCover, Light, Border.
// Out:  FineSurfaces: the cells that the border would answer wrongly, with their screen points.
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "optimizer/readback/covered_surfaces.h"
#include "optimizer/readback/depth_tiles.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// One image of the finer cover and what is to be covered in it.
struct FineSurfaces {
  Surfaces surfaces;          // without tiles, boundary and counts
  DepthTiles tiles;           // of what is to be covered
  Matrix34d ray_from_screen;  // of the light's rays, RayFromWorld()

  // Calls visit(screen) for every cell that is to be covered, as screen points (x, y, d, 1) of this
  // image, until a StopScope says so.
  template <typename Visitor>
  void ForEach(const Visitor& visit) const {
    if (tiles.grids.empty()) return;  // stopped
    const CoveredSurfaces covered = {surfaces, tiles};
    ForEachTile(tiles.grids[0], [&](const DepthTile& tile) { covered.ForEach(tile, visit); });
  }
};

// At the nearest and at the furthest depth of the cells, those that have anything to be covered.
// None without a finer cover, and where it does not know what the border answers wrongly.
ScratchVector<FineSurfaces> FindFineSurfaces(const Surfaces& surfaces,
                                             const Light& light,
                                             Border border);

}  // namespace lightfit
