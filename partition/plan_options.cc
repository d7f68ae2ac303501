#include "partition/plan_options.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "partition/plan.h"

namespace lightfit {

namespace {

// Whether guard and margin leave something of a map whose shorter side this is, texels.
bool HasRoomIn(int64_t side, const PlanOptions& options) {
  const double on_every_side = options.guard_texels + options.fit.margin_texels;
  return 2.0 * on_every_side < static_cast<double>(side);
}

absl::Status NoRoomError(absl::string_view size, const PlanOptions& options) {
  const double guard = options.guard_texels, margin = options.fit.margin_texels;
  const bool has_both = guard > 0.0 && margin > 0.0;
  std::string around;
  if (guard > 0.0) around = absl::StrFormat("guard of %g", guard);
  if (has_both) absl::StrAppend(&around, " and the ");
  if (margin > 0.0) absl::StrAppend(&around, absl::StrFormat("margin of %g", margin));
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: the %s texels on every side %s nothing of a map; want larger maps, or "
                      "less around them",
                      size,
                      around,
                      has_both ? "leave" : "leaves"));
}

absl::Status ValidateEach(const PlanOptions& options) {
  const MapSize each = *options.each;
  const std::string size = absl::StrFormat("options.each = %dx%d", each.width, each.height);
  if (!ValidateMapSize(each).ok()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s, want 1 ... %d texels each way", size, kMaxMapSide));
  }
  if (!HasRoomIn(std::min(each.width, each.height), options)) return NoRoomError(size, options);
  return absl::OkStatus();
}

}  // namespace

int64_t LeastPlanTexels(const PlanOptions& options) {
  const int64_t least = LeastPlanTexels(options.max_maps);
  if (!options.sizes.has_value()) return least;
  const int64_t side = AllowedSides(*options.sizes).front();
  return std::max(least, side * side * options.max_maps);
}

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
  if (options.each.has_value()) {
    if (options.sizes.has_value()) {
      return absl::InvalidArgumentError(
          "options.each and sizes: one size for all maps, or sizes to choose from; want "
          "one of the two");
    }
    return ValidateEach(options);
  }
  if (options.sizes.has_value()) {
    const MapSizeRules& sizes = *options.sizes;
    absl::Status status = ValidateMapSizeRules(sizes, /*margin_texels=*/0.0, "options.sizes");
    if (!status.ok()) return status;
    if (!HasRoomIn(AllowedSides(sizes).front(), options)) {
      return NoRoomError(absl::StrCat("options.sizes.min_side = ", sizes.min_side), options);
    }
  }
  const int64_t least = LeastPlanTexels(options);
  if (options.texels < least || options.texels > kMostPlanTexels) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.texels = %d, want %d ... %d for %d maps",
                        options.texels,
                        least,
                        kMostPlanTexels,
                        options.max_maps));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
