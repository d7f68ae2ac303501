// optimizer/readback/depth_tiles.h
//
// Tiles that bound the surfaces of a read-back in depth, coarse ones made of finer ones.
// In:   Readback, which of its pixels are meant.
// Out:  DepthTiles: grids of boxes (x, y, affine depth).
//
// Rays are linear in (x, y, d, 1), so that those of all surfaces in a tile lie in the hull of the
// rays at the eight corners of its box.   math.md 2
#pragma once

#include <cstdint>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/affine_depth.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// A rectangle of pixels, begin included, end excluded, and the range of affine depth of its
// surfaces, if it has any.
struct DepthTile {
  int x_begin, y_begin, x_end, y_end;
  double d_min, d_max;
  int num_surfaces;
};

// Tiles that cover the image, in row order.
struct TileGrid {
  int columns = 0;
  int rows = 0;
  ScratchVector<DepthTile> tiles;
};

// Which surfaces of a read-back are meant: those whose word has one of the bits.
struct SurfaceFilter {
  absl::Span<const uint32_t> words;  // row-major, one for each pixel; must outlive its tiles
  uint32_t mask = 0;                 // 0: all surfaces, and no words

  bool Has(size_t pixel) const { return mask == 0 || (words[pixel] & mask) != 0; }
};

struct DepthTiles {
  SurfaceFilter filter;
  // Finest first; a tile of each further grid is made of kTilesPerSide^2 tiles of the one before.
  ScratchVector<TileGrid> grids;
  int64_t num_surfaces = 0;
  int64_t num_background = 0;  // of all pixels, whatever the filter

  static constexpr int kTilesPerSide = 4;
};

// Not to be looked at once a StopScope says so: the grids may be missing.
DepthTiles BuildDepthTiles(const Readback& readback,
                           const AffineDepth& affine_depth,
                           SurfaceFilter filter);

// Calls visit(x, y, d) at every surface of the tile that the filter lets through, in row order.
template <typename Visitor>
void ForEachSurface(const Readback& readback,
                    const AffineDepth& affine_depth,
                    SurfaceFilter filter,
                    const DepthTile& tile,
                    const Visitor& visit) {
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    for (int x = tile.x_begin; x < tile.x_end; ++x) {
      const size_t pixel = readback.Index(x, y);
      if (!filter.Has(pixel)) continue;
      const double depth = readback.depth[pixel];
      if (affine_depth.IsSurface(depth)) visit(x, y, affine_depth.At(x, y, depth));
    }
  }
}

}  // namespace lightfit
