#include "jobs/matrix_judge.h"

#include <utility>

#include "optimizer/evaluate.h"
#include "partition/evaluate_plan.h"

namespace lightfit {

namespace {

// What the surfaces of a read-back were found with must be the same for all who ask of them.
SampleOptions OnTheSameSurfaces(SampleOptions samples, const FitOptions& options) {
  samples.max_depth_bend = options.samples.max_depth_bend;
  samples.depth_noise = options.samples.depth_noise;
  return samples;
}

FitOptions OwnOptions(const FitOptions& options) {
  FitOptions own = FigureOptions(options);
  own.samples = options.samples;
  return own;
}

}  // namespace

FitOptions FigureOptions(const FitOptions& options) {
  FitOptions figures = options;
  figures.samples = OnTheSameSurfaces(SampleOptions(), options);
  figures.cover = Cover::kShadowed;
  figures.border = BorderChoice::kAutomatic;  // whichever the view is made for
  return figures;
}

absl::StatusOr<Figures> OwnFiguresOf(const LightPlan& plan,
                                     const Surfaces& surfaces,
                                     const Light& light,
                                     const PlanOptions& options,
                                     bool foretells) {
  const FitOptions own = OwnOptions(options.fit);
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, plan.border, own);
  if (!view.ok()) return view.status();
  const Plan looked_up = PlanOf(plan);
  return foretells ? EvaluatePlan(*view, looked_up, own, options.guard_texels)
                   : MeasurePlan(*view, looked_up, own, options.guard_texels);
}

absl::StatusOr<MatrixJudge> MatrixJudge::Of(const Surfaces& surfaces,
                                            const Light& light,
                                            Border border,
                                            const FitOptions& options) {
  MatrixJudge judge;
  judge.options_ = FigureOptions(options);
  judge.own_options_ = OwnOptions(options);
  absl::StatusOr<LightView> view = ViewLight(surfaces, light, border, judge.options_);
  if (!view.ok()) return view.status();
  judge.view_ = *std::move(view);
  if (options.samples == judge.options_.samples) return judge;
  view = ViewLight(surfaces, light, border, judge.own_options_);
  if (!view.ok()) return view.status();
  judge.own_view_ = *std::move(view);
  return judge;
}

absl::StatusOr<JudgedMatrix> MatrixJudge::operator()(absl::StatusOr<LightMatrix> matrix) const {
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

absl::StatusOr<JudgedPlan> MatrixJudge::operator()(LightPlan plan, double guard_texels) const {
  const Plan looked_up = PlanOf(plan);
  absl::StatusOr<Figures> figures = EvaluatePlan(*view_, looked_up, options_, guard_texels);
  if (!figures.ok()) return figures.status();
  absl::StatusOr<Figures> own = figures;
  if (own_view_.has_value()) {
    own = EvaluatePlan(*own_view_, looked_up, own_options_, guard_texels);
  }
  if (!own.ok()) return own.status();
  return JudgedPlan{std::move(plan), *std::move(figures), *std::move(own)};
}

}  // namespace lightfit
