// partition/tracking/lay_plan.h
//
// From maps that were kept, moved or fitted anew to the plan of this frame.
// In:   the LightView, the maps, what each of them holds.
// Out:  LightPlan: the maps' matrices to the last bit but for depth rows, and their figures here.
//
// A depth row stays as long as all receivers lie in it. A new one has room, so that a map that is
// kept need not be drawn again because something further away came into view.
#pragma once

#include "absl/status/statusor.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "partition/fit_plan.h"
#include "partition/tracking/held_bins.h"
#include "partition/tracking/kept_map.h"

namespace lightfit {

// `guard_texels`: as PlanLookUp has them. `depth_room`: what a new depth row has on either side, as
// a share of the range of depth. Here and below: CancelledError once a StopScope says so.
absl::StatusOr<LightPlan> LayPlan(const LightView& view,
                                  const KeptMaps& maps,
                                  const HeldBins& held,
                                  const FitOptions& fit,
                                  double guard_texels,
                                  double depth_room);

// A plan of one map, which holds the view's cover and is asked by all.
absl::StatusOr<LightPlan> LayPlanOfOne(const LightView& view,
                                       const KeptMap& map,
                                       const FitOptions& fit,
                                       double depth_room);

// The maps as they are, with no figures: where nothing needs them.
LightPlan LayUnused(const LightView& view, const KeptMaps& maps);

}  // namespace lightfit
