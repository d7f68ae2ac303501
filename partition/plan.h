// partition/plan.h : several maps for one light, and which of them a receiver asks.
//
// In:      the light's maps, with the half spaces that each of them serves; a receiver.
// Out:     Plan {maps, border}; PlanLookUp: the map that the receiver asks, and where in it.
// Symbols: X ray, H_k map_from_ray, w_k = h3.X, q_k = w_k |det H_k|^(-1/3).  docs/mathematics.md 11
//
// Any map may be asked about any ray in its rectangle, as whatever casters lie on that ray are
// drawn into it: which one is asked is a matter of quality, and never of correctness. The densest
// is, and as the ratio of two maps' densities belongs to the ray alone, whatever surface it meets,
// a dot product for each map tells which one that is. Schemes that have a rule of their own (by the
// camera's depth, by the face of the view) say it by half spaces.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"

namespace lightfit {

// The most maps that one light may have.
inline constexpr int kMaxPlanMaps = 32;

struct PlanMap {
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();  // LightMatrix::map_from_world
  MapSize size;                                                  // texels

  // The receivers that may ask this map: those with n . (x, y, z, 1) >= 0 for every one, world.
  // None: all.
  ScratchVector<Eigen::RowVector4d> half_spaces;
};

struct Plan {
  ScratchString light_name;
  Border border = Border::kLit;  // what a receiver finds that no map may be asked about
  ScratchVector<PlanMap> maps;
};

// A plan of a single map, whoever made it.
Plan PlanOfOneMap(absl::string_view light_name,
                  const Eigen::Matrix4d& map_from_world,
                  MapSize size,
                  Border border);

// Texels of all maps.
int64_t NumTexels(const Plan& plan);

// A receiver's map and the place in it, (u, v) in texels.
struct PlanPlace {
  int map = -1;  // -1: no map may be asked
  Eigen::Vector2d texel = Eigen::Vector2d::Zero();
};

class PlanLookUp {
 public:
  // Of every map the outermost `guard_texels` are not asked about, so that a filter of twice that
  // width stays in the map. >= 0. InvalidArgument when the plan has no maps or too many, or a
  // matrix is not one of this light (MapFromRay()), or the guard leaves nothing of a map.
  static absl::StatusOr<PlanLookUp> Create(const Plan& plan,
                                           const Light& light,
                                           double guard_texels = 0.0);

  // Of the maps whose half spaces and rectangle hold the receiver the densest: the one of least
  // q_k; of equals the first.   math.md (20)
  PlanPlace At(const Eigen::Vector3d& world) const;

  // Whether map k may be asked about the receiver, and the place in it.
  bool IsAskable(int k, const Eigen::Vector3d& world, Eigen::Vector2d* texel) const;

  // Whether all half spaces of map k hold the receiver.
  bool IsServed(int k, const Eigen::Vector3d& world) const;

  // q_k of the receiver: a share of 1 / (density of texels)^(1/3), the same for all maps.
  double CoarsenessOf(int k, const Eigen::Vector3d& world) const;

  int num_maps() const { return static_cast<int>(maps_.size()); }

 private:
  struct Map {
    Eigen::Matrix<double, 3, 4> rows;  // (u w, v w, w) of a world point, of determinant 1
    MapSize size;
    absl::Span<const Eigen::RowVector4d> half_spaces;
  };

  double guard_texels_ = 0.0;
  ScratchVector<Map> maps_;  // refer to the plan
};

}  // namespace lightfit
