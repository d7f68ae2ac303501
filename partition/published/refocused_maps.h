// partition/published/refocused_maps.h : two maps by two methods, each around its own side of the
// plane between them.
//
// In:   MethodInput, whose map is the budget: both maps together have at most its texels; two
//       methods.
// Out:  the Plan of the best round, or all rounds.
// Flow:  both methods around all that is in view -> the plane where they are equally dense -> each
//       around its side of it -> the plane of these -> ... -> the round with the smallest texels on
//       the screen.
//
// Mikkelsen 2007, section 6: separating plane shadow maps, refocused. He takes the last of 10 to 20
// rounds. Of a directional light's rounds each has the plane that its maps were fitted around, and
// a receiver asks the map on its side. For a point light that does not settle: a perspective map is
// densest where it does not look, so that the maps swap their sides in every round. Its receivers
// ask the denser of the maps that hold them, which the plane does not bind. For both the best round
// is kept, by the mean side of a texel over the view (view_grid.h), which is ours.
//
// Where a side is empty, or one map is the denser one everywhere, that map remains, with all the
// texels: the last of the rounds.
//
// Errors: as of the methods. A round after the first whose maps cannot be had ends the search.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "partition/plan.h"

namespace lightfit {

struct RefocusOptions {
  Method first = Method::kFocused;
  Method second = Method::kLispsm;
  int max_rounds = 20;         // >= 1; 1: both maps around all of the view
  double margin_texels = 0.0;  // around each map: what PlanLookUp guards. >= 0
};

struct RefocusRound {
  Plan plan;
  Eigen::RowVector4d plane;  // >= 0 on the first map's side, world; 0 where one map remains
  int only = -1;             // of the methods whose map remains, 0 or 1
  double texel_side = 0.0;   // mean over the view, pixels
};

struct RefocusRounds {
  std::vector<RefocusRound> rounds;  // at least one
  size_t best = 0;                   // the first with the least texel_side
};

absl::StatusOr<RefocusRounds> RefocusMaps(const MethodInput& input,
                                          const RefocusOptions& options = {});

// The best of the rounds.
absl::StatusOr<Plan> SeparatingPlanePlan(const MethodInput& input,
                                         const RefocusOptions& options = {});

}  // namespace lightfit
