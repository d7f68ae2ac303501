#include "optimizer/readback/depth_tiles.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/stop.h"
#include "geometry/affine_depth.h"
#include "optimizer/readback/kernels.h"

namespace lightfit {

namespace {

// Side of the finest tiles, pixels: small enough to bound depth well, and many pixels to a tile.
int TileSize(int width, int height) { return std::max(width, height) <= 512 ? 8 : 16; }

// Grids are merged until one has at most this many tiles.
constexpr size_t kMaxCoarsestTiles = 64;

TileGrid MergeTiles(const TileGrid& fine) {
  constexpr int kSide = DepthTiles::kTilesPerSide;
  TileGrid coarse;
  coarse.columns = (fine.columns + kSide - 1) / kSide;
  coarse.rows = (fine.rows + kSide - 1) / kSide;
  coarse.tiles.reserve(static_cast<size_t>(coarse.columns) * coarse.rows);
  for (int row = 0; row < fine.rows; row += kSide) {
    for (int column = 0; column < fine.columns; column += kSide) {
      const int last_row = std::min(row + kSide, fine.rows) - 1;
      const int last_column = std::min(column + kSide, fine.columns) - 1;
      DepthTile merged = fine.tiles[static_cast<size_t>(row) * fine.columns + column];
      const DepthTile& last =
          fine.tiles[static_cast<size_t>(last_row) * fine.columns + last_column];
      merged.x_end = last.x_end;
      merged.y_end = last.y_end;
      merged.num_surfaces = 0;
      for (int y = row; y <= last_row; ++y) {
        for (int x = column; x <= last_column; ++x) {
          const DepthTile& tile = fine.tiles[static_cast<size_t>(y) * fine.columns + x];
          if (tile.num_surfaces == 0) continue;
          const bool first = merged.num_surfaces == 0;
          merged.d_min = first ? tile.d_min : std::min(merged.d_min, tile.d_min);
          merged.d_max = first ? tile.d_max : std::max(merged.d_max, tile.d_max);
          merged.num_surfaces += tile.num_surfaces;
        }
      }
      coarse.tiles.push_back(merged);
    }
  }
  return coarse;
}

internal::DepthIntervals Intervals(const AffineDepth& affine_depth) {
  return {static_cast<float>(affine_depth.surface_min()),
          static_cast<float>(affine_depth.surface_max()),
          static_cast<float>(affine_depth.background_min()),
          static_cast<float>(affine_depth.background_max())};
}

// The range of affine depth over a tile. Depth kinds that are monotonic in d give it from their own
// range; distances need each pixel's.
void SetAffineRange(const Readback& readback,
                    const AffineDepth& affine_depth,
                    SurfaceFilter filter,
                    const internal::DepthStatistics& statistics,
                    DepthTile* tile) {
  if (affine_depth.is_pixel_independent()) {
    const double a = affine_depth.At(0, 0, statistics.min);
    const double b = affine_depth.At(0, 0, statistics.max);
    tile->d_min = std::min(a, b);
    tile->d_max = std::max(a, b);
    return;
  }
  tile->d_min = std::numeric_limits<double>::infinity();
  tile->d_max = -tile->d_min;
  ForEachSurface(readback, affine_depth, filter, *tile, [tile](int, int, double d) {
    tile->d_min = std::min(tile->d_min, d);
    tile->d_max = std::max(tile->d_max, d);
  });
}

}  // namespace

DepthTiles BuildDepthTiles(const Readback& readback,
                           const AffineDepth& affine_depth,
                           SurfaceFilter filter) {
  const int width = readback.width();
  const int height = readback.height();
  const internal::DepthIntervals intervals = Intervals(affine_depth);
  const int tile_size = TileSize(width, height);
  DepthTiles result;
  result.filter = filter;
  TileGrid finest;
  finest.columns = (width + tile_size - 1) / tile_size;
  finest.rows = (height + tile_size - 1) / tile_size;
  finest.tiles.reserve(static_cast<size_t>(finest.columns) * finest.rows);
  for (int y = 0; y < height; y += tile_size) {
    if (StopRequested()) return result;
    for (int x = 0; x < width; x += tile_size) {
      DepthTile tile = {
          x, y, std::min(x + tile_size, width), std::min(y + tile_size, height), 0.0, 0.0, 0};
      const size_t first = static_cast<size_t>(y) * width + x;
      const internal::DepthStatistics statistics =
          internal::ScanDepth(readback.depth.data() + first,
                              filter.mask == 0 ? nullptr : filter.words.data() + first,
                              filter.mask,
                              width,
                              tile.x_end - x,
                              tile.y_end - y,
                              intervals);
      result.num_background += statistics.num_background;
      result.num_surfaces += statistics.num_surface;
      tile.num_surfaces = statistics.num_surface;
      if (tile.num_surfaces > 0) {
        SetAffineRange(readback, affine_depth, filter, statistics, &tile);
      }
      finest.tiles.push_back(tile);
    }
  }
  result.grids.push_back(std::move(finest));
  while (result.grids.back().tiles.size() > kMaxCoarsestTiles) {
    result.grids.push_back(MergeTiles(result.grids.back()));
  }
  return result;
}

}  // namespace lightfit
