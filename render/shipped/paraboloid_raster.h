// render/shipped/paraboloid_raster.h
//
// A pair of paraboloids as a rasteriser draws it: casters are bent, as only their corners are
// projected.
// In:   a Scene, a ParaboloidPair, how far its maps are moved, the texels that somebody looks up.
// Out:  of each such texel the distances of all triangles drawn on its centre.
//
// As hardware does it (Brabec et al. 2002; Osman et al. 2006): the corners of a triangle are taken
// to the plane of a half, uv = (d_x, d_y) / (1 + d_z) with the distance from the light as depth;
// there it is clipped, and filled linearly. So an edge is off its arc by ChordError()
// (partition/shipped/paraboloid_edges.h), and the depth between corners is off as well.
//  - A half draws what has d_z >= -k w, w a texel's width at the rim and k `rim_texels`; the plane
//    between the halves is d_z = 0. Triangles with corners on either side are cut where d_z,
//    linear between the corners, falls below. At the rim d_z falls by a texel's width from one
//    texel to the next: the few texels beyond hold the centres of those that the rim cuts.
//  - Corners are rounded to 1/256 of a texel, and a centre on the edge between two triangles
//    belongs to the one on whose top or left edge it lies: no gaps and no texel twice.
//    docs/published_plans.md
//
// Edge cases: a triangle with a corner at the light, or straight behind a half that it reaches
// into, has no image there and is left out of it. What the cut leaves further off than
// four radii of the disc is cut away.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "partition/shipped/paraboloid.h"
#include "render/shipped/texel_grid.h"
#include "render/texel_maps.h"
#include "scenes/scene.h"

namespace lightfit {

// The texels of a pair.
inline TexelGrid GridOf(const ParaboloidPair& pair) { return {pair.size, 2}; }

struct ParaboloidRasterOptions {
  double rim_texels = 4.0;  // 0 ... 1000
};

absl::Status ValidateParaboloidRasterOptions(const ParaboloidRasterOptions& options);

class ParaboloidRaster : public TexelHits {
 public:
  // `wanted`: a flag for each texel of GridOf(pair). Maps are moved as MovedMaps says.
  // For a valid pair and options. Does not depend on the number of threads.
  ParaboloidRaster(const Scene& scene,
                   const ParaboloidPair& pair,
                   const Eigen::Vector2d& move,
                   absl::Span<const uint8_t> wanted,
                   int num_threads,
                   const ParaboloidRasterOptions& options = {});

  double First(int32_t texel) const override;
  bool HasBehind(int32_t texel, double resolution, double far) const override;

  // Ascending; none of texels that are not wanted.
  absl::Span<const double> DistancesOf(int32_t texel) const;

 private:
  std::vector<int64_t> begin_;  // of each texel, and of the end, in `distances_`
  std::vector<double> distances_;
};

}  // namespace lightfit
