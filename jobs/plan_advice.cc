#include "jobs/plan_advice.h"

#include "absl/strings/str_format.h"
#include "partition/fit_plan.h"

namespace lightfit {

namespace {

// How many maps a light takes that has no single one; 0: there is no plan either.
int NumMapsThatDo(const Surfaces& surfaces,
                  const Light& light,
                  MapSize map,
                  const FitOptions& options) {
  // Any rays at all have a plan of so many: one for each face of a cube.
  constexpr int kAlwaysEnough = 6;
  PlanOptions plan_options;
  plan_options.fit = options;
  plan_options.texels = int64_t{map.width} * map.height;
  plan_options.choose_by_forecast = false;
  for (int num_maps = 2; num_maps <= kAlwaysEnough; ++num_maps) {
    plan_options.max_maps = num_maps;
    const absl::StatusOr<LightPlan> plan = FitPlan(surfaces, light, plan_options);
    if (plan.ok()) return static_cast<int>(plan->maps.size());
    if (!absl::IsFailedPrecondition(plan.status())) return 0;
  }
  return 0;
}

}  // namespace

absl::Status WithNumMaps(const absl::Status& status,
                         const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options,
                         absl::string_view field) {
  if (!absl::IsFailedPrecondition(status) || light.kind != Light::Kind::kPoint) return status;
  const int num_maps = NumMapsThatDo(surfaces, light, map, options);
  if (num_maps == 0) return status;
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s. A plan of %d maps (%s = %d) would do", status.message(), num_maps, field, num_maps));
}

}  // namespace lightfit
