// partition/shipped/paraboloid_plane.h : where the plane between two paraboloids lies best.
//
// In:      samples as directions from the light; triangles that cast, or none.
// Out:     the plane's normal, and what it costs.
// Symbols: d direction, n normal, g footprint of a texel of one radian.
//
// Osman et al. 2006 (4) leave the plane to the scene's author: it is where maps bend most, and
// triangles that it cuts are drawn twice. But a rim is only bent, and has four times the density of
// the middle. In a pair a texel reaches
//   (2 / size) (1 + |n.d|) g(d),   g^2 = (trace G) / 2,
// on the screen whatever its orientation, as the map is conformal; so the normal of the least sum
// is that of the least mean of |n.d|: across the samples' directions.   docs/published_plans.md
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "absl/types/span.h"
#include "partition/shipped/direction_samples.h"

namespace lightfit {

using CasterTriangle = std::array<Eigen::Vector3d, 3>;

struct ParaboloidPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double footprints = 1.0;  // mean over samples of 1 + |n.d|, weighted by g: 1 ... 2
  double share_cut = 0.0;   // of the triangles
};

// 200 directions on a spiral over the half sphere around (0, 0, 1): a normal and its opposite are
// one plane.
const std::vector<Eigen::Vector3d>& ParaboloidNormals();

// The normal of ParaboloidNormals() with the least footprints + cut_penalty * share_cut; the first
// of equals. `triangles` relative to the light; one is cut when it has corners on both sides.
// Without samples footprints are 1 everywhere.
ParaboloidPlane BestParaboloidPlane(absl::Span<const DirectionSample> samples,
                                    absl::Span<const CasterTriangle> triangles = {},
                                    double cut_penalty = 0.0);

// The two costs of one normal, unit.
ParaboloidPlane PlaneWithCosts(const Eigen::Vector3d& normal,
                               absl::Span<const DirectionSample> samples,
                               absl::Span<const CasterTriangle> triangles = {});

// Sum over samples of weight times footprint, read-back pixels, in a pair of maps of `size` texels
// a side.
double SumOfFootprints(const Eigen::Vector3d& normal,
                       int size,
                       absl::Span<const DirectionSample> samples);

}  // namespace lightfit
