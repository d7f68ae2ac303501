#include "jobs/schemes/judge_maps.h"

#include "render/judge_plan.h"
#include "render/shipped/judge_rays.h"

namespace lightfit {

absl::StatusOr<ShadowImage> JudgeMaps(const RayCaster& caster,
                                      const SurfaceImage& image,
                                      absl::Span<const Lighting> truth,
                                      const Light& light,
                                      const SchemeMaps& maps,
                                      const JudgeOptions& options) {
  if (const auto* pair = std::get_if<ParaboloidPair>(&maps.maps)) {
    return JudgeParaboloids(caster, image, truth, light, *pair, options);
  }
  if (const auto* rasterised = std::get_if<RasterisedPair>(&maps.maps)) {
    return JudgeDrawnParaboloids(caster, image, truth, light, rasterised->pair, options);
  }
  if (const auto* pages = std::get_if<PagedMap>(&maps.maps)) {
    return JudgePages(caster, image, truth, light, *pages, options);
  }
  const Plan& plan = std::get<Plan>(maps.maps);
  return JudgePlan(caster, image, truth, light, plan, options, maps.guard_texels);
}

absl::StatusOr<ShadowImage> JudgeMapsFirstPhase(const RayCaster& caster,
                                                const SurfaceImage& image,
                                                absl::Span<const Lighting> truth,
                                                const Light& light,
                                                const SchemeMaps& maps,
                                                const JudgeOptions& options) {
  const Plan* plan = PlanOf(maps);
  return plan != nullptr
             ? JudgePlanFirstPhase(caster, image, truth, light, *plan, options, maps.guard_texels)
             : JudgeMaps(caster, image, truth, light, maps, options);
}

}  // namespace lightfit
