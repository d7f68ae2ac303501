// partition/published/plan_parts.h
//
// The last step of plans whose parts are fitted one by one: a size for each map.
// In:      per part the map of what it serves, and its half spaces; MethodInput, whose map is the
//          budget: all maps together have at most its texels.
// Out:     Plan.
// Symbols: M_u, M_v largest errors of a map of one texel (storage_factor.h); W x H its size.
//
// Lloyd et al. 2006, 4.2: a map's two errors are alike at the aspect W/H = M_u/M_v (13, 14), and
// the errors of several maps at texels in proportion to M_u M_v.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "partition/plan.h"

namespace lightfit {

enum class PlanShapes {
  kEqualSquares,  // as engines keep them in an array
  kAspects,       // as many texels for each, at its own aspect
  kByStorage      // ... and in proportion to its storage factor
};

struct PlanPart {
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();  // of a map of one texel
  std::vector<Eigen::Vector4d> half_spaces;                      // inside is >= 0
  std::vector<Eigen::Vector3d> corners;                          // of what it serves, world
};

// A map of about W/H = `aspect` > 0, of at most `texels`, both sides at least `min_side`, of which
// the square must be within `texels`.
MapSize SizeOfAspect(double texels, double aspect, int min_side = 1);

// Around what its map serves each part has `margin_texels`, >= 0, or a millionth of the map.
// InvalidArgument when there are more parts than a plan may have, or too few texels for them.
absl::StatusOr<Plan> PlanOfParts(const MethodInput& input,
                                 const std::vector<PlanPart>& parts,
                                 PlanShapes shapes,
                                 double margin_texels);

}  // namespace lightfit
