// render/judge_plan.h
//
// The shadows that several maps of one light give, and where they are wrong.
// In:   a RayCaster, what the camera sees, the true lighting, a light and its Plan.
// Out:  the shadow images under the two bias models of render/judge.h, and the wrong pixels.
//
// A receiver asks the densest map that holds it, PlanLookUp's rule, and finds the plan's border
// where no map may be asked.   math.md 10, 11
//
// In each phase every map is moved by the same part of a texel of its own, and the receiver asks
// the maps as they then lie: the moved rectangle must hold it. A move changes neither w nor
// |det H|, hence not which of two maps is the denser.
#pragma once

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/plan.h"
#include "render/judge.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// `outside` of the wrong pixels counts those that no map may be asked about; `guard_texels` as
// PlanLookUp has them, of the moved maps. InvalidArgument for options out of range, when the maps
// have too many texels, and for a plan that PlanLookUp refuses: without maps, with a matrix that is
// not one of this light, or of which the guard leaves nothing.
absl::StatusOr<ShadowImage> JudgePlan(const RayCaster& caster,
                                      const SurfaceImage& image,
                                      absl::Span<const Lighting> truth,
                                      const Light& light,
                                      const Plan& plan,
                                      const JudgeOptions& options = {},
                                      double guard_texels = 0.0);

// The same of phase 0 alone, in its share of the time: the same images, and counts of that phase.
absl::StatusOr<ShadowImage> JudgePlanFirstPhase(const RayCaster& caster,
                                                const SurfaceImage& image,
                                                absl::Span<const Lighting> truth,
                                                const Light& light,
                                                const Plan& plan,
                                                const JudgeOptions& options = {},
                                                double guard_texels = 0.0);

}  // namespace lightfit
