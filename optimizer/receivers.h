// optimizer/receivers.h
//
// What a read-back says before any light is looked at: computed once, used by every light.
// In:   Readback, SampleOptions.
// Out:  depth tiles that bound all receivers, and the pixels at a shadow boundary of any light with
//       their position, affine depth derivatives and surface normal.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback.h"

namespace lightfit {

// A rectangle of pixels, begin included, end excluded, and the range of affine depth of its
// surfaces, if it has any. As rays are linear in (x, y, d, 1), those of all its surfaces lie in the
// hull of the rays at the eight corners of the box.   math.md 2
struct DepthTile {
  int x_begin, y_begin, x_end, y_end;
  double d_min, d_max;
  int num_receivers;
};

// Tiles that cover the image, in row order.
struct TileGrid {
  int columns = 0;
  int rows = 0;
  std::vector<DepthTile> tiles;
};

// A pixel at a shadow boundary of some light, where the surface continues to all four neighbours.
struct BoundaryPixel {
  int x, y;                  // column and row
  uint32_t lights;           // bits that differ from a neighbour's
  double d;                  // affine depth at the pixel's centre
  double d_x, d_y;           // its screen derivatives, per pixel: exact on a plane
  Eigen::Vector3d position;  // world
  Eigen::Vector3d normal;    // of the surface, unit, towards the eye; world
  bool edge_on_to_eye;       // by SampleOptions::min_cos_eye
};

struct Receivers {
  Receivers(const Readback& readback, const SampleOptions& options)
      : readback(readback),
        options(options),
        affine_depth(readback.camera, readback.depth_kind),
        world_from_screen(readback.camera.WorldFromScreen()) {}

  Readback readback;
  SampleOptions options;
  AffineDepth affine_depth;  // of the read-back's camera and depth kind
  Eigen::Matrix4d world_from_screen;
  // Finest first; a tile of each further grid is made of kTilesPerSide^2 tiles of the one before.
  std::vector<TileGrid> tile_grids;
  std::vector<BoundaryPixel> boundary;  // in pixel order
  std::array<SampleCounts, kMaxLights>
      counts;  // by shadow bit; used, facing_away, edge_on are 0 yet

  static constexpr int kTilesPerSide = 4;

  // Calls visit(x, y, d) at every receiver of the tile, in row order.
  template <typename Visitor>
  void ForEachReceiver(const DepthTile& tile, const Visitor& visit) const;
};

// Looks at the shadow bits in `light_mask` only. Pixels in the outermost rows and columns have no
// central differences and never count as boundary. InvalidArgument when the read-back is not valid
// or has no receiver at all.
absl::StatusOr<Receivers> FindReceivers(const Readback& readback,
                                        uint32_t light_mask,
                                        const SampleOptions& options);

// Affine depth and its derivatives at an inner pixel, from central differences. False at a depth
// discontinuity and next to the background: SampleOptions::max_depth_bend says what that means.
struct DepthGradient {
  double d, d_x, d_y;
};
bool DepthGradientAt(const Readback& readback,
                     const AffineDepth& affine_depth,
                     const SampleOptions& options,
                     int x,
                     int y,
                     DepthGradient* gradient);

// The unit normal, towards the eye, of the plane that has this affine depth gradient at the centre
// of the pixel; world space.
Eigen::Vector3d SurfaceNormal(const Eigen::Matrix4d& screen_from_world,
                              bool orthographic,
                              int x,
                              int y,
                              const DepthGradient& gradient);

// ---- inline bodies ----

template <typename Visitor>
void Receivers::ForEachReceiver(const DepthTile& tile, const Visitor& visit) const {
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    for (int x = tile.x_begin; x < tile.x_end; ++x) {
      const double depth = readback.depth[static_cast<size_t>(y) * readback.width() + x];
      if (affine_depth.IsSurface(depth)) visit(x, y, affine_depth.At(x, y, depth));
    }
  }
}

}  // namespace lightfit
