// partition/fit_plan.h : from a read-back to several maps for one light, in one call.
//
// In:      Surfaces of a read-back, a Light, PlanOptions.
// Out:     LightPlan {maps, border, energy}.
// Flow:    LightView -> ServedRays (bins) -> cells, grown and alternated -> texels divided ->
//          LightMatrix of each cell.   docs/mathematics.md 11
// Errors:  InvalidArgument: an input is wrong; the message names field, value and remedy.
//          FailedPrecondition: there is nothing to fit, or more maps are needed than may be; the
//          message says how many. Cancelled: a StopScope said so.
// Threads, memory: as optimizer/fit.h.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"
#include "partition/plan_options.h"

namespace lightfit {

struct LightPlan {
  ScratchString light_name;
  Border border = Border::kLit;
  FacingSource facing = FacingSource::kGuessed;

  // Sizes may differ; figures are over the boundary samples that ask the map.
  ScratchVector<LightMatrix> maps;

  // Sum over the boundary samples in FitOptions::metric, each in the map that it asks; those
  // outside of all maps, lit ones at a lit border, are in none. As Figures::energy.
  double energy = 0.0;

  // Foretold, as Figures::wrong_share; where plans were chosen by it.
  std::optional<double> wrong_share;
};

// What a look-up needs of it.
Plan PlanOf(const LightPlan& plan);

// The plan for one light. With a finer cover (FitOptions::use_fine_cover) it has room for that, or
// not, where less is foretold without or so many maps cannot have it all in front. Of one map it is
// FitLight(), with a map that is square unless PlanOptions::each says otherwise.
absl::StatusOr<LightPlan> FitPlan(const Surfaces& surfaces,
                                  const Light& light,
                                  const PlanOptions& options = {});

}  // namespace lightfit
