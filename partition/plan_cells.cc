#include "partition/plan_cells.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "partition/divided_maps.h"
#include "partition/find_cells.h"
#include "partition/sphere_cells.h"

namespace lightfit {

PlanCells::PlanCells(const ServedRays& rays,
                     const Light& light,
                     const FitOptions& fit,
                     const PlanOptions& options)
    : light_(light),
      options_(options),
      fitter_(rays, light, fit),
      grown_(GrowCells(fitter_, options.max_maps)) {}

absl::StatusOr<Cells> PlanCells::Of(int num_maps) const {
  const double texels = TexelsOf(num_maps);
  Cells cells;
  if (!grown_.empty()) cells = grown_[std::min<size_t>(num_maps, grown_.size()) - 1];
  if (light_.kind == Light::Kind::kPoint) {
    Cells clusters = ClusterCells(fitter_, num_maps, texels);
    if (!clusters.empty() && (cells.empty() || DividedMaps(fitter_, clusters, texels).Energy() <
                                                   DividedMaps(fitter_, cells, texels).Energy())) {
      cells = std::move(clusters);
    }
  }
  if (absl::Status status = CheckStop(light_); !status.ok()) return status;
  if (cells.empty()) {
    return fitter_.rays().has_single_cover
               ? absl::FailedPreconditionError(absl::StrFormat(
                     "light \"%s\": no map can be fitted to what it shows", light_.name))
               : SurroundedByError(num_maps);
  }
  cells = AlternateCells(fitter_, cells, texels);
  if (absl::Status status = CheckStop(light_); !status.ok()) return status;
  return cells;
}

double PlanCells::TexelsOf(int num_maps) const {
  if (!options_.each.has_value()) return static_cast<double>(options_.texels);
  return static_cast<double>(options_.each->width) * options_.each->height * num_maps;
}

// Receivers all around, and too few maps for them.
absl::Status PlanCells::SurroundedByError(int num_maps) const {
  const int enough = NumMapsAround(fitter_, num_maps + 1);
  if (absl::Status status = CheckStop(light_); !status.ok()) return status;
  return absl::FailedPreconditionError(
      absl::StrFormat("light \"%s\": at (%g, %g, %g) it hangs among its receivers, and no %d maps "
                      "have all of them in front; %d would do",
                      light_.name,
                      light_.position.x(),
                      light_.position.y(),
                      light_.position.z(),
                      num_maps,
                      enough));
}

}  // namespace lightfit
