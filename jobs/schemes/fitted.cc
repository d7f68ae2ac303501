#include "jobs/schemes/fitted.h"

#include "partition/fit_plan.h"

namespace lightfit {

Scheme FittedScheme(const std::string& name, const PlanOptions& options) {
  return {name, [options](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            if (!input.surfaces.ok()) return input.surfaces.status();
            const absl::StatusOr<LightPlan> plan = FitPlan(*input.surfaces, input.light, options);
            if (!plan.ok()) return plan.status();
            return SchemeMaps{PlanOf(*plan), options.guard_texels};
          }};
}

FitOptions LineOptions(const FitOptions& fit) {
  FitOptions line = FitOptions::AsPublished(fit);
  line.ray_space = RaySpace::kNormalized;
  line.sample_by_sample = false;
  return line;
}

PlanOptions OneMapOf(const FitOptions& fit, MapSize map, double guard_texels) {
  PlanOptions options;
  options.fit = fit;
  options.max_maps = 1;
  options.each = map;
  options.guard_texels = guard_texels;
  return options;
}

}  // namespace lightfit
