// partition/map_depths.h
//
// The depth rows of several maps, over the receivers that ask each of them.
// In:   the LightView, the maps.
// Out:  MapDepths; rows that have all of them in 0 ... 1.   docs/mathematics.md 11
//
// A receiver asks the densest map that holds it, whatever cell its bin is in, so that what a cell
// covers does not bound what its map is asked about: the read-back's pixels do, and of the finer
// cover what must have room.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/homography.h"
#include "geometry/ray_maps.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"

namespace lightfit {

// Of the receivers that ask a map; z in the depth row that it has. What is nearer to the light than
// those that it must serve may have less: it is lit.
struct MapDepths {
  double least_w = std::numeric_limits<double>::infinity();
  double most_w = 0.0;
  double least_w_served = std::numeric_limits<double>::infinity();
  double least_z_served = std::numeric_limits<double>::infinity();
  double most_z = -std::numeric_limits<double>::infinity();

  bool IsAsked() const { return most_w > 0.0; }
  bool Fits() const;  // but for rounding
};

// Element k is of the map k. Of `fit` counts the cover, finer or not; `guard_texels` as PlanLookUp
// has them. Of no use once a StopScope says so.
ScratchVector<MapDepths> FindMapDepths(const LightView& view,
                                       const FitOptions& fit,
                                       absl::Span<const RayMap> maps,
                                       absl::Span<const Eigen::Matrix4d> map_from_world,
                                       double guard_texels);

// Lays the depth row of a map that is asked: over `distances`, DistancesFromLight(), for a
// directional light. `room`: on either side, as a share of the range, and more than a little for
// what lies between pixels.
void LayDepthRow(const Light& light,
                 const MapDepths& depths,
                 DepthRange distances,
                 double room,
                 Eigen::Matrix4d* map_from_world);

}  // namespace lightfit
