#include "optimizer/receivers.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "optimizer/readback_kernels.h"

namespace lightfit {

namespace {

// Side of the finest tiles, pixels: small enough to bound depth well, and many pixels to a tile.
int TileSize(int width, int height) { return std::max(width, height) <= 512 ? 8 : 16; }

// Grids are merged until one has at most this many tiles.
constexpr size_t kMaxCoarsestTiles = 64;

TileGrid MergeTiles(const TileGrid& fine) {
  constexpr int kSide = Receivers::kTilesPerSide;
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
      merged.num_receivers = 0;
      for (int y = row; y <= last_row; ++y) {
        for (int x = column; x <= last_column; ++x) {
          const DepthTile& tile = fine.tiles[static_cast<size_t>(y) * fine.columns + x];
          if (tile.num_receivers == 0) continue;
          const bool first = merged.num_receivers == 0;
          merged.d_min = first ? tile.d_min : std::min(merged.d_min, tile.d_min);
          merged.d_max = first ? tile.d_max : std::max(merged.d_max, tile.d_max);
          merged.num_receivers += tile.num_receivers;
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
void SetAffineRange(const Receivers& receivers,
                    const AffineDepth& affine_depth,
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
  receivers.ForEachReceiver(*tile, [tile](int, int, double d) {
    tile->d_min = std::min(tile->d_min, d);
    tile->d_max = std::max(tile->d_max, d);
  });
}

absl::Status NoReceiversError(const Readback& readback, int64_t num_invalid, int64_t num_pixels) {
  if (num_invalid == 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "readback.depth: all %d pixels are background, want at least one surface (depth kind %s)",
        num_pixels,
        DepthKindName(readback.depth_kind)));
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "readback.depth: no surface; %d of %d pixels are NaN, negative or out of range for depth "
      "kind "
      "%s (the first value is %g). Is this the depth channel, and is its depth kind right?",
      num_invalid,
      num_pixels,
      DepthKindName(readback.depth_kind),
      readback.depth[0]));
}

}  // namespace

bool DepthGradientAt(const Readback& readback,
                     const AffineDepth& affine_depth,
                     const SampleOptions& options,
                     int x,
                     int y,
                     DepthGradient* gradient) {
  const int width = readback.width();
  if (x < 1 || y < 1 || x + 1 >= width || y + 1 >= readback.height()) return false;
  const float* centre = readback.depth.data() + static_cast<size_t>(y) * width + x;
  const float left = centre[-1], right = centre[1];
  const float above = centre[-width], below = centre[width];
  if (!affine_depth.IsSurface(*centre) || !affine_depth.IsSurface(left) ||
      !affine_depth.IsSurface(right) || !affine_depth.IsSurface(above) ||
      !affine_depth.IsSurface(below)) {
    return false;
  }
  const double d = affine_depth.At(x, y, *centre);
  const double to_left = affine_depth.At(x - 1, y, left) - d;
  const double to_right = affine_depth.At(x + 1, y, right) - d;
  const double to_above = affine_depth.At(x, y - 1, above) - d;
  const double to_below = affine_depth.At(x, y + 1, below) - d;
  const double noise = options.depth_noise * std::abs(d);
  const auto bends = [&](double back, double ahead) {
    const double second = std::abs(back + ahead);
    const double first = std::max(std::abs(back), std::abs(ahead));
    return second > options.max_depth_bend * first && second > noise;
  };
  if (bends(to_left, to_right) || bends(to_above, to_below)) return false;
  *gradient = {d, 0.5 * (to_right - to_left), 0.5 * (to_below - to_above)};
  return true;
}

Eigen::Vector3d SurfaceNormal(const Eigen::Matrix4d& screen_from_world,
                              bool orthographic,
                              int x,
                              int y,
                              const DepthGradient& gradient) {
  // The plane d = d0 + d_x (x - x0) + d_y (y - y0), as a covector on (x, y, d, 1) and then on world
  // points. Its value at the eye is negative for a perspective camera (whose eye is at d =
  // infinity) and positive for an orthographic one (d = -infinity).
  const Eigen::Vector4d plane_in_screen(
      gradient.d_x,
      gradient.d_y,
      -1.0,
      gradient.d - gradient.d_x * (x + 0.5) - gradient.d_y * (y + 0.5));
  const Eigen::Vector3d normal = screen_from_world.leftCols<3>().transpose() * plane_in_screen;
  return (orthographic ? 1.0 : -1.0) * normal.normalized();
}

absl::StatusOr<Receivers> FindReceivers(const Readback& readback,
                                        uint32_t light_mask,
                                        const SampleOptions& options) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  const int width = readback.width();
  const int height = readback.height();
  Receivers receivers(readback, options);
  const AffineDepth& affine_depth = receivers.affine_depth;
  const internal::DepthIntervals intervals = Intervals(affine_depth);
  const int tile_size = TileSize(width, height);
  int64_t num_receivers = 0, num_background = 0;
  TileGrid finest;
  finest.columns = (width + tile_size - 1) / tile_size;
  finest.rows = (height + tile_size - 1) / tile_size;
  finest.tiles.reserve(static_cast<size_t>(finest.columns) * finest.rows);
  for (int y = 0; y < height; y += tile_size) {
    for (int x = 0; x < width; x += tile_size) {
      DepthTile tile = {
          x, y, std::min(x + tile_size, width), std::min(y + tile_size, height), 0.0, 0.0, 0};
      const internal::DepthStatistics statistics =
          internal::ScanDepth(readback.depth.data() + static_cast<size_t>(y) * width + x,
                              width,
                              tile.x_end - x,
                              tile.y_end - y,
                              intervals);
      num_background += statistics.num_background;
      num_receivers += statistics.num_surface;
      tile.num_receivers = statistics.num_surface;
      if (tile.num_receivers > 0) SetAffineRange(receivers, affine_depth, statistics, &tile);
      finest.tiles.push_back(tile);
    }
  }
  receivers.tile_grids.push_back(std::move(finest));
  while (receivers.tile_grids.back().tiles.size() > kMaxCoarsestTiles) {
    receivers.tile_grids.push_back(MergeTiles(receivers.tile_grids.back()));
  }
  const int64_t num_pixels = static_cast<int64_t>(width) * height;
  const int64_t num_invalid = num_pixels - num_receivers - num_background;
  if (num_receivers == 0) return NoReceiversError(readback, num_invalid, num_pixels);
  for (SampleCounts& counts : receivers.counts) {
    counts.receivers = num_receivers;
    counts.invalid_depth = num_invalid;
  }

  const Eigen::Matrix4d screen_from_world = receivers.world_from_screen.inverse();
  const Eigen::Vector3d eye =
      receivers.world_from_screen.block<3, 1>(0, 2) /
      (readback.camera.orthographic ? 1.0 : receivers.world_from_screen(3, 2));
  std::vector<int32_t> columns(width);
  for (int y = 1; y + 1 < height; ++y) {
    const uint32_t* row = readback.shadow_bits.data() + static_cast<size_t>(y) * width;
    const size_t num_columns =
        internal::ScanBoundary(row, width, width, light_mask, columns.data());
    for (size_t i = 0; i < num_columns; ++i) {
      BoundaryPixel pixel;
      const int x = columns[i];
      pixel.x = x;
      pixel.y = y;
      pixel.lights = light_mask & ((row[x] ^ row[x - 1]) | (row[x] ^ row[x + 1]) |
                                   (row[x] ^ row[x - width]) | (row[x] ^ row[x + width]));
      DepthGradient gradient;
      const bool is_surface =
          affine_depth.IsSurface(readback.depth[static_cast<size_t>(y) * width + x]);
      const bool continues =
          is_surface && DepthGradientAt(readback, affine_depth, options, x, y, &gradient);
      for (uint32_t bits = pixel.lights; bits != 0; bits &= bits - 1) {
        SampleCounts& counts = receivers.counts[std::countr_zero(bits)];
        ++counts.candidates;
        if (!is_surface) {
          ++counts.background;
        } else if (!continues) {
          ++counts.discontinuity;
        }
      }
      if (!continues) continue;
      pixel.d = gradient.d;
      pixel.d_x = gradient.d_x;
      pixel.d_y = gradient.d_y;
      const Eigen::Vector4d position =
          receivers.world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, gradient.d, 1.0);
      pixel.position = position.head<3>() / position.w();
      pixel.normal = SurfaceNormal(screen_from_world, readback.camera.orthographic, x, y, gradient);
      const Eigen::Vector3d to_eye = readback.camera.orthographic
                                         ? Eigen::Vector3d(-eye)
                                         : Eigen::Vector3d(eye - pixel.position);
      pixel.edge_on_to_eye = !(pixel.normal.dot(to_eye) >= options.min_cos_eye * to_eye.norm());
      receivers.boundary.push_back(pixel);
    }
  }
  return receivers;
}

}  // namespace lightfit
