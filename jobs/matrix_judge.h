// jobs/matrix_judge.h
//
// The figures that tables and result files are over, the same for every matrix and plan of a light.
// In:   Surfaces, a light, a border; matrices and plans, whoever made them.
// Out:  JudgedMatrix, JudgedPlan: figures over the samples of all tables, and over the fit's own.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/surfaces.h"
#include "partition/fit_plan.h"
#include "partition/plan_options.h"

namespace lightfit {

// A matrix with its figures, foretold wrong pixels among them.
struct JudgedMatrix {
  LightMatrix matrix;
  Figures figures;      // over the samples that all tables are over: FigureOptions()
  Figures own_figures;  // over the samples of the fit that was asked for, for its result file
};

// A plan with the same. Samples outside of all maps are in no figure (EvaluatePlan()).
struct JudgedPlan {
  LightPlan plan;
  Figures figures;
  Figures own_figures;
};

// What every table's figures are over, whichever way a matrix was made: the samples that a fit
// takes by default (SampleOptions), in the metric of `options`.
FitOptions FigureOptions(const FitOptions& options);

// What MatrixJudge calls own_figures of a plan; the forecast only where `foretells`.
absl::StatusOr<Figures> OwnFiguresOf(const LightPlan& plan,
                                     const Surfaces& surfaces,
                                     const Light& light,
                                     const PlanOptions& options,
                                     bool foretells);

// Judges matrices of one light, whatever their borders, over the edges that a map with one border
// serves.
class MatrixJudge {
 public:
  // `options` are those of the fit. Surfaces and light must outlive the judge.
  static absl::StatusOr<MatrixJudge> Of(const Surfaces& surfaces,
                                        const Light& light,
                                        Border border,
                                        const FitOptions& options);

  // Errors pass through.
  absl::StatusOr<JudgedMatrix> operator()(absl::StatusOr<LightMatrix> matrix) const;
  absl::StatusOr<JudgedPlan> operator()(LightPlan plan, double guard_texels) const;

 private:
  MatrixJudge() = default;

  FitOptions options_, own_options_;
  std::optional<LightView> view_;
  std::optional<LightView> own_view_;  // absent: the same
};

}  // namespace lightfit
