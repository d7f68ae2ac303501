// optimizer/readback/covered_surfaces.h
//
// The receivers that one light's map must cover, tile by tile and one by one.
// In:   Surfaces, tiles of those to cover.
// Out:  their screen points and rays, which are too many to keep: whoever wants them goes through
//       them again.
#pragma once

#include <Eigen/Core>
#include <array>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/ray_cone.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

using Matrix34d = Eigen::Matrix<double, 3, 4>;

// The corners of a tile's box of pixel centres and affine depths, as screen points (x, y, d, 1).
std::array<Eigen::Vector4d, 8> Corners(const DepthTile& tile);

// Calls visit(tile) for every tile of a grid that has a receiver, until a StopScope says so.
template <typename Visitor>
void ForEachTile(const TileGrid& grid, const Visitor& visit) {
  for (const DepthTile& tile : grid.tiles) {
    if (StopRequested()) return;
    if (tile.num_surfaces > 0) visit(tile);
  }
}

struct CoveredSurfaces {
  const Surfaces& surfaces;
  const DepthTiles& tiles;

  // Calls visit(screen) for every one of the tile, as screen points (x, y, d, 1).
  template <typename Visitor>
  void ForEach(const DepthTile& tile, const Visitor& visit) const {
    ForEachSurface(
        surfaces.readback,
        surfaces.affine_depth,
        tiles.filter,
        tile,
        [&visit](int x, int y, double d) { visit(Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0)); });
  }
};

// The first of every tile of a grid that has any, as screen points.
ScratchVector<Eigen::Vector4d> OneReceiverPerTile(const CoveredSurfaces& covered, size_t grid);

// All rays, as FeasibleAxis() in geometry/ray_cone.h asks for them. The lowest along an axis is
// looked for only in tiles whose box reaches below what was found so far.
UnitRaySum SumOfUnitRays(const CoveredSurfaces& covered, const Matrix34d& ray_from_screen);
Eigen::Vector3d LowestOfUnitRays(const CoveredSurfaces& covered,
                                 const Matrix34d& ray_from_screen,
                                 const Eigen::Vector3d& axis);

}  // namespace lightfit
