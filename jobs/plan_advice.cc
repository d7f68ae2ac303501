#include "jobs/plan_advice.h"

#include "absl/strings/str_format.h"
#include "optimizer/light_view.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/plan_options.h"
#include "partition/sphere_cells.h"

namespace lightfit {

absl::Status WithNumMaps(const absl::Status& status,
                         const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options,
                         absl::string_view field,
                         int most_maps) {
  if (!absl::IsFailedPrecondition(status) || light.kind != Light::Kind::kPoint) return status;
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, options);
  if (!view.ok()) return status;
  const absl::StatusOr<int> num_maps = NumMapsAround(*view, options);
  if (!num_maps.ok() || *num_maps == 0 || *num_maps > most_maps) return status;
  if (TexelsOf(map) < LeastPlanTexels(*num_maps)) return status;
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s. A plan of %d maps (%s = %d) would do", status.message(), *num_maps, field, *num_maps));
}

}  // namespace lightfit
