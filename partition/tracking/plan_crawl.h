// partition/tracking/plan_crawl.h
//
// How much what is looked up in a light's plan crawls from one frame to the next.
// In:   two consecutive read-backs and the light's plan in each.
// Out:  Crawl, as of one map (optimizer/figures/stability.h).   math.md (14), (20)
//
// Each point is followed in the map that it asks. Map k of the later plan is taken to be map k of
// the earlier one, redrawn or not; where a point asks another than before its texel is a new one.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/figures/stability.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"

namespace lightfit {

// One frame of a sequence, and a light's plan in it.
struct PlannedFrame {
  Readback readback;
  const Plan& plan;

  // Of `readback`, where they have been found already; null: found when they are needed.
  const Surfaces* surfaces = nullptr;
};

// Points that no map of either frame may be asked about are left out. `guard_texels` as in
// PlanLookUp. InvalidArgument for inputs that cannot be used; each plan must be one of this light.
absl::StatusOr<Crawl> MeasurePlanCrawl(const PlannedFrame& before,
                                       const PlannedFrame& after,
                                       const Light& light,
                                       double guard_texels = 0.0,
                                       const SampleOptions& options = {});

}  // namespace lightfit
