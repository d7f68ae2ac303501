// partition/shipped/paraboloid.h : dual paraboloid maps of a lamp, and their look-up.
//
// In:      a point light, the normal of the plane between its two halves, texels of both maps.
// Out:     ParaboloidPair; the place of a receiver in it, and the ray of a place.
// Symbols: d direction from the light in a half's frame, unit, d_z along the half's axis; uv in the
//          disc of radius 1; texels t = size (uv + 1) / 2.
//
// Osman, Bukowski & McEvoy 2006 (and Brabec et al. 2002): uv = (d_x, d_y) / (1 + d_z) in each half.
// It is stereographic projection, so angles are kept, and a small length grows by the factor
// 1 / (1 + d_z): 1/2 in the middle of a half and 1 at its rim. A straight edge becomes an arc of a
// circle, which a rasteriser draws as its chord (paraboloid_edges.h).
//
// No 4x4 matrix does this, so a pair is not a Plan. Look-ups project each receiver by itself, as
// the paper's pixel shader does, and compare distances from the light.   docs/published_plans.md
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/shipped/texel_ray.h"

namespace lightfit {

// Requires a unit d with d_z > -1.
Eigen::Vector2d ParaboloidFromDirection(const Eigen::Vector3d& d);

// Its inverse, unit: (2 u, 2 v, 1 - r^2) / (1 + r^2), r = |uv|. Beyond the rim, r > 1, it goes on
// into the other half: there lie the centres of texels that the rim cuts.
Eigen::Vector3d DirectionFromParaboloid(const Eigen::Vector2d& uv);

// Area of uv for an area of directions: 1 / (1 + d_z)^2.
double ParaboloidDensity(double d_z);

struct ParaboloidPlace {
  int half = -1;  // 0 on the normal's side, 1 on the other; -1: the receiver is the light itself
  Eigen::Vector2d texel = Eigen::Vector2d::Zero();  // 0 <= u, v < size
};

struct ParaboloidPair {
  std::string light_name;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // the light, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit: the axis of half 0, world
  int size = 0;  // texels: the side of each half's square, whose inscribed disc is used

  // Rows: x, y and the axis of a half, right-handed, so that neither map is mirrored.
  Eigen::Matrix3d HalfFromWorld(int half) const;

  ParaboloidPlace At(const Eigen::Vector3d& world) const;

  // Of a place in or around the disc; for a texel's centre (column + 1/2, row + 1/2).
  TexelRay RayAt(const ParaboloidPlace& place) const;

  // Places of a filter around the receiver, for offsets in texels of its own half. They are offsets
  // of the direction, each projected by the half that it falls in, as the paper proposes (5): so a
  // filter crosses the seam, and takes no texel outside of the discs. Empty for the light itself.
  std::vector<ParaboloidPlace> FilterAt(const Eigen::Vector3d& world,
                                        absl::Span<const Eigen::Vector2d> offsets_texels) const;
};

// Texels of both squares.
int64_t NumTexels(const ParaboloidPair& pair);

// The pair of the largest squares that the budget allows. `normal`: any length but 0.
// FailedPrecondition for a directional light; InvalidArgument for a light or normal out of range,
// and when the budget leaves no texel.
absl::StatusOr<ParaboloidPair> MakeParaboloidPair(const Light& light,
                                                  const Eigen::Vector3d& normal,
                                                  int64_t max_texels);

}  // namespace lightfit
