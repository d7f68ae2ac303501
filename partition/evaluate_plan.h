// partition/evaluate_plan.h
//
// How good a plan is, in the figures of a single map.
// In:   a LightView, a Plan, options.
// Out:  Figures, foretold wrong pixels among them.   docs/mathematics.md 11
#pragma once

#include "absl/status/statusor.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "partition/plan.h"

namespace lightfit {

// EvaluatePlan() without the forecast, which takes a pass over the pixels. `of_maps`, where it is
// not null, gets the figures of each map over the samples that ask it.
absl::StatusOr<Figures> MeasurePlan(const LightView& view,
                                    const Plan& plan,
                                    const FitOptions& options = {},
                                    double guard_texels = 0.0,
                                    ScratchVector<Figures>* of_maps = nullptr);

// As EvaluateMatrix(), each sample in the map that it asks. Samples outside of all maps, which the
// border answers, are in no figure: FootprintStatistics::num_behind says how many. Half spaces of
// the maps count for the samples and not for the forecast.
//
// `guard_texels` as PlanLookUp has them, >= 0; the forecast is made without. Errors as
// EvaluateMatrix(), and as PlanLookUp::Create(); FailedPrecondition when no sample asks a map.
absl::StatusOr<Figures> EvaluatePlan(const LightView& view,
                                     const Plan& plan,
                                     const FitOptions& options = {},
                                     double guard_texels = 0.0);

// ForetellWrongShare() of a plan, as if every receiver asked the densest map that holds it; half
// spaces and guard do not count.
absl::StatusOr<double> ForetellPlan(const Readback& readback,
                                    const Light& light,
                                    const Plan& plan,
                                    const SampleOptions& samples);

}  // namespace lightfit
