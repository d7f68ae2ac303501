#include "partition/plan_options.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "partition/plan.h"

namespace lightfit {

absl::Status ValidatePlanOptions(const PlanOptions& options) {
  if (absl::Status status = ValidateFitOptions(options.fit); !status.ok()) return status;
  if (options.max_maps < 1 || options.max_maps > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.max_maps = %d, want 1 ... %d", options.max_maps, kMaxPlanMaps));
  }
  if (!(options.guard_texels >= 0.0) || !std::isfinite(options.guard_texels)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.guard_texels = %g, want 0 or more: half the width of the filter",
                        options.guard_texels));
  }
  const double margin = options.guard_texels + options.fit.margin_texels;
  if (options.each.has_value()) {
    if (options.sizes.has_value()) {
      return absl::InvalidArgumentError(
          "options.each and options.sizes: one size for all maps, or sizes to choose from; want "
          "one of the two");
    }
    return ValidateMapSize(*options.each, margin);
  }
  int64_t least = LeastPlanTexels(options.max_maps);
  if (options.sizes.has_value()) {
    if (absl::Status status = ValidateMapSizeRules(*options.sizes, margin); !status.ok()) {
      return status;
    }
    const int64_t side = AllowedSides(*options.sizes).front();
    least = std::max(least, side * side * options.max_maps);
  }
  const int64_t most = int64_t{kMaxMapSide} * kMaxMapSide;
  if (options.texels < least || options.texels > most) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.texels = %d, want %d ... %d for %d maps",
                        options.texels,
                        least,
                        most,
                        options.max_maps));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
