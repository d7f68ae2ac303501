// jobs/schemes/judge_maps.h
//
// The shadows that any scheme's maps give, and where they are wrong.
// In:   a RayCaster, what the camera sees, the true lighting, a light and its SchemeMaps.
// Out:  as JudgePlan() (render/judge_plan.h), JudgeParaboloids() and JudgePages()
//       (render/shipped/judge_rays.h).
#pragma once

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "jobs/schemes/scheme.h"
#include "render/judge.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

absl::StatusOr<ShadowImage> JudgeMaps(const RayCaster& caster,
                                      const SurfaceImage& image,
                                      absl::Span<const Lighting> truth,
                                      const Light& light,
                                      const SchemeMaps& maps,
                                      const JudgeOptions& options = {});

// The same images in less time where the maps are matrices, as JudgePlanFirstPhase(); the counts
// are of any phases.
absl::StatusOr<ShadowImage> JudgeMapsFirstPhase(const RayCaster& caster,
                                                const SurfaceImage& image,
                                                absl::Span<const Lighting> truth,
                                                const Light& light,
                                                const SchemeMaps& maps,
                                                const JudgeOptions& options = {});

}  // namespace lightfit
