// optimizer/readback/surfaces.h
//
// What a read-back says before any light is looked at: computed once, used by every light and
// every choice of samples.
// In:   Readback, SampleOptions.
// Out:  depth tiles that bound all receivers, and the pixels at a shadow boundary of any light with
//       their position, affine depth derivatives and surface normal.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/affine_depth.h"
#include "geometry/light.h"
#include "optimizer/readback/depth_tiles.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_counts.h"
#include "optimizer/readback/sample_options.h"

namespace lightfit {

// A pixel at a shadow boundary of some light, on a surface whose plane its neighbours tell.
struct BoundaryPixel {
  int x, y;                  // column and row
  uint32_t lights;           // bits that differ from those of a neighbour with a surface
  double d;                  // affine depth at the pixel's centre
  double d_x, d_y;           // its screen derivatives, per pixel: exact on a plane
  Eigen::Vector3d position;  // world
  Eigen::Vector3d normal;    // of the surface, unit, towards the eye; world
  // Cosine between the normal and the way to the eye, times the eye's distance; and that distance.
  double eye_along_normal, eye_distance;
  bool is_outline;  // the derivative is that of one side (SampleOptions::use_outlines)
};

struct Surfaces {
  Surfaces(const Readback& readback, const SampleOptions& options)
      : readback(readback),
        options(options),
        affine_depth(AffineDepthOf(readback)),
        world_from_screen(readback.camera.WorldFromScreen()) {}

  Readback readback;
  SampleOptions options;     // of which max_depth_bend and depth_noise count here
  AffineDepth affine_depth;  // of the read-back's camera and depth kind
  Eigen::Matrix4d world_from_screen;
  DepthTiles tiles;                       // of all receivers
  ScratchVector<BoundaryPixel> boundary;  // in pixel order, outlines among them
  std::array<SampleCounts, kMaxLights>
      counts;  // by shadow bit; used, facing_away, edge_on are 0 yet
};

// Looks at the shadow bits in `light_mask` only. Pixels in the outermost rows and columns have no
// central differences and never count as boundary. What is found serves any choice of samples with
// the same max_depth_bend and depth_noise (SelectSamples()): once for a read-back is enough.
// InvalidArgument when the read-back is not valid or has no receiver at all; CancelledError once a
// StopScope says so.
absl::StatusOr<Surfaces> FindSurfaces(const Readback& readback,
                                      uint32_t light_mask,
                                      const SampleOptions& options);

// How often FindSurfaces() was called since the program began, by all threads: it is the one pass
// over all pixels, and tests hold jobs to one for each read-back.
int64_t NumSurfacesFound();

// Affine depth and its derivatives at an inner pixel: central differences where the surface
// continues to both sides (SampleOptions::max_depth_bend). At an outline or a crease, where it does
// not, the difference to the side whose next pixel continues it best, or false without
// SampleOptions::use_outlines.
// False where there is no surface, or none on either side.
struct DepthGradient {
  double d, d_x, d_y;
  bool is_one_sided = false;  // along x or y
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

}  // namespace lightfit
