#include "cli/comparison.h"

#include <chrono>

#include "optimizer/fit.h"

namespace lightfit {

FitOptions FocusedOptions(const FitOptions& options) {
  FitOptions focused = options;
  focused.search = Search::kFocused;
  focused.affine = Affine::kMinAreaRectangle;
  return focused;
}

FitOptions PublishedOptions(const FitOptions& options) {
  FitOptions published = FitOptions::AsPublished();
  published.samples = options.samples;
  published.metric = options.metric;
  published.along_edge_share = options.along_edge_share;
  published.margin_percent = options.margin_percent;
  published.margin_texels = options.margin_texels;
  return published;
}

Comparison Compare(const Readback& readback,
                   const Light& light,
                   MapSize map,
                   const FitOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  absl::StatusOr<LightMatrix> final = FitLight(readback, light, map, options);
  const double time_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  if (!final.ok()) return FailedComparison(light, final.status());
  return {light,
          FitLight(readback, light, map, FocusedOptions(options)),
          FitLight(readback, light, map, PublishedOptions(options)),
          *std::move(final),
          time_ms};
}

Comparison FailedComparison(const Light& light, const absl::Status& status) {
  return {light, status, status, status, 0};
}

}  // namespace lightfit
