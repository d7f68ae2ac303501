#include "optimizer/search/search_options.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "geometry/enclosing_rectangle.h"
#include "optimizer/search/refine_ceres.h"

namespace lightfit {

namespace {

absl::Status OutOfRange(const char* field, double value, const char* want) {
  return absl::InvalidArgumentError(
      absl::StrFormat("options.%s = %g, want %s", field, value, want));
}

}  // namespace

absl::Status ValidateSearchOptions(const SearchOptions& options) {
  // Written so that NaN fails.
  if (!(options.margin_percent >= 0.0 && options.margin_percent <= 100.0)) {
    return OutOfRange("margin_percent", options.margin_percent, "0 ... 100");
  }
  if (!(options.margin_texels >= 0.0 && std::isfinite(options.margin_texels))) {
    return OutOfRange("margin_texels", options.margin_texels, "0 or more texels");
  }
  if (!(options.min_w > 0.0 && options.min_w < 1.0)) {
    return OutOfRange("min_w", options.min_w, "more than 0, less than 1");
  }
  if (!(options.along_edge_share > 0.0 && options.along_edge_share <= 1.0)) {
    return OutOfRange("along_edge_share", options.along_edge_share, "more than 0, at most 1");
  }
  if (options.reweighting_rounds < 1) {
    return OutOfRange("reweighting_rounds", options.reweighting_rounds, "1 or more");
  }
  if (options.line_search_rounds < 1) {
    return OutOfRange("line_search_rounds", options.line_search_rounds, "1 or more");
  }
  if (options.grid_directions < 3) {
    return OutOfRange("grid_directions", options.grid_directions, "3 or more");
  }
  if (options.sample_by_sample && options.affine == Affine::kMinEnergyParallelogram) {
    return absl::InvalidArgumentError(
        "options.sample_by_sample: the parallelogram of least energy needs the summary; choose "
        "another fitter or leave sample_by_sample off");
  }
  if (options.sample_by_sample && options.search != Search::kFocused &&
      options.search != Search::kRotationLineSearch) {
    return absl::InvalidArgumentError(
        "options.sample_by_sample: only kFocused and kRotationLineSearch run sample by sample");
  }
  if (options.refiner == Refiner::kCeres && !HasCeres()) {
    return absl::UnimplementedError(
        "options.refiner = kCeres: this build has no Ceres (LIGHTFIT_WITH_CERES=OFF); take "
        "kTinySolver, which minimises the same cost");
  }
  if (options.affine == Affine::kMinAreaRectangleCgal) {
    const Polygon triangle = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
    return MinAreaRectangleCgal(triangle).status();
  }
  return absl::OkStatus();
}

}  // namespace lightfit
