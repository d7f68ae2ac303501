// partition/tracking/kept_map.h
//
// One map of a plan as the frame before left it, seen in this frame.
// In:   its matrix and size; the frame's LightView.
// Out:  KeptMap; the same moved by whole texels.   math.md 7
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/map_size.h"
#include "geometry/ray_maps.h"
#include "optimizer/light_view.h"
#include "optimizer/tracking/keep_matrix.h"

namespace lightfit {

struct KeptMap {
  Eigen::Matrix4d map_from_world;
  MapSize size;
  RayMap rays;  // the same, of the view's normalised rays
  TrackerAction action = TrackerAction::kKept;
};
using KeptMaps = ScratchVector<KeptMap>;

// InvalidArgument when the matrix is not one of the view's light (MapFromRay()).
absl::StatusOr<KeptMap> MakeKeptMap(const LightView& view,
                                    const Eigen::Matrix4d& map_from_world,
                                    MapSize size,
                                    TrackerAction action);

// The map itself where all these rays lie in it, but for rounding and its outermost texels; else
// moved by whole texels so that they do; nothing where they do not fit.
std::optional<KeptMap> ShiftedToHold(const KeptMap& map,
                                     const ScratchVector<Eigen::Vector3d>& rays,
                                     double guard_texels);

ScratchVector<RayMap> RayMapsOf(const KeptMaps& maps);

// Whether texels moved over surfaces.
bool IsRedrawn(TrackerAction action);

}  // namespace lightfit
