#include "jobs/fit_comparison.h"

#include <chrono>
#include <optional>
#include <utility>

#include "optimizer/evaluate.h"
#include "optimizer/fit.h"

namespace lightfit {

namespace {

// Judges matrices of one light, whatever their borders, over the edges that a map with this one
// serves.
class Judge {
 public:
  static absl::StatusOr<Judge> Of(const Surfaces& surfaces,
                                  const Light& light,
                                  Border border,
                                  const FitOptions& options) {
    Judge judge;
    judge.options_ = FigureOptions(options);
    judge.own_options_ = judge.options_;
    judge.own_options_.samples = options.samples;
    absl::StatusOr<LightView> view = ViewLight(surfaces, light, border, judge.options_);
    if (!view.ok()) return view.status();
    judge.view_ = *std::move(view);
    if (options.samples == judge.options_.samples) return judge;
    view = ViewLight(surfaces, light, border, judge.own_options_);
    if (!view.ok()) return view.status();
    judge.own_view_ = *std::move(view);
    return judge;
  }

  absl::StatusOr<JudgedMatrix> operator()(absl::StatusOr<LightMatrix> matrix) const {
    if (!matrix.ok()) return matrix.status();
    absl::StatusOr<Figures> figures =
        EvaluateMatrix(*view_, matrix->map_from_world, matrix->map, options_, matrix->border);
    if (!figures.ok()) return figures.status();
    absl::StatusOr<Figures> own = figures;
    if (own_view_.has_value()) {
      own = EvaluateMatrix(
          *own_view_, matrix->map_from_world, matrix->map, own_options_, matrix->border);
    }
    if (!own.ok()) return own.status();
    return JudgedMatrix{*std::move(matrix), *std::move(figures), *std::move(own)};
  }

 private:
  FitOptions options_, own_options_;
  std::optional<LightView> view_;
  std::optional<LightView> own_view_;  // absent: the same
};

// What the surfaces of a read-back were found with must be the same for all who ask of them.
SampleOptions OnTheSameSurfaces(SampleOptions samples, const FitOptions& options) {
  samples.max_depth_bend = options.samples.max_depth_bend;
  samples.depth_noise = options.samples.depth_noise;
  return samples;
}

}  // namespace

FitOptions FigureOptions(const FitOptions& options) {
  FitOptions figures = options;
  figures.samples = OnTheSameSurfaces(SampleOptions(), options);
  figures.cover = Cover::kShadowed;
  figures.border = BorderChoice::kAutomatic;  // whichever the view is made for
  return figures;
}

FitComparison CompareFit(const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  absl::StatusOr<LightMatrix> final = FitLight(surfaces, light, map, options);
  const double time_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  if (!final.ok()) return FailedFitComparison(light, final.status());
  const absl::StatusOr<Judge> judge = Judge::Of(surfaces, light, final->border, options);
  if (!judge.ok()) return FailedFitComparison(light, judge.status());
  return {light,
          (*judge)(FitLight(surfaces, light, map, FitOptions::Focused(options))),
          (*judge)(FitLight(surfaces, light, map, FitOptions::AsPublished(options))),
          (*judge)(std::move(final)),
          time_ms};
}

ComparedReadback CompareLights(const Readback& readback,
                               absl::Span<const Light> lights,
                               absl::Span<const absl::Status> light_status,
                               MapSize map,
                               const FitOptions& options,
                               const std::function<void(const Light&)>& before_light) {
  ComparedReadback result = {FindSurfaces(readback, LightMask(lights), options.samples), {}};
  for (size_t i = 0; i < lights.size(); ++i) {
    before_light(lights[i]);
    const absl::Status& status = light_status[i].ok() ? result.surfaces.status() : light_status[i];
    result.comparisons.push_back(status.ok() ? CompareFit(*result.surfaces, lights[i], map, options)
                                             : FailedFitComparison(lights[i], status));
  }
  return result;
}

FitComparison FailedFitComparison(const Light& light, const absl::Status& status) {
  return {light, status, status, status, 0};
}

}  // namespace lightfit
