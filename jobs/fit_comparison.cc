#include "jobs/fit_comparison.h"

#include <chrono>
#include <utility>

#include "optimizer/fit.h"

namespace lightfit {

namespace {

absl::StatusOr<JudgedMatrix> Judged(const Readback& readback,
                                    const Light& light,
                                    absl::StatusOr<LightMatrix> matrix,
                                    const FitOptions& options) {
  if (!matrix.ok()) return matrix.status();
  absl::StatusOr<MatrixFigures> figures =
      EvaluateMatrix(readback, light, matrix->map_from_world, matrix->map, options);
  if (!figures.ok()) return figures.status();
  return JudgedMatrix{*std::move(matrix), *std::move(figures)};
}

}  // namespace

FitOptions FocusedOptions(const FitOptions& options) {
  FitOptions focused = options;
  focused.search = Search::kFocused;
  focused.affine = Affine::kMinAreaRectangle;
  focused.cover = Cover::kReceivers;
  return focused;
}

FitOptions PublishedOptions(const FitOptions& options) {
  FitOptions published = FitOptions::AsPublished();
  published.samples.min_samples = options.samples.min_samples;
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
  const auto yardstick = [&](const FitOptions& yardstick_options) {
    return Judged(readback, light, FitLight(readback, light, map, yardstick_options), options);
  };
  return {light,
          yardstick(FocusedOptions(options)),
          yardstick(PublishedOptions(options)),
          Judged(readback, light, std::move(final), options),
          time_ms};
}

Comparison FailedComparison(const Light& light, const absl::Status& status) {
  return {light, status, status, status, 0};
}

}  // namespace lightfit
