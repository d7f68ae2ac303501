// jobs/fit_comparison.h
//
// One light fitted by the method asked for, beside the two methods that people know.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/figures/evaluate.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// A matrix, and its figures by one measure for all: the metric and the samples asked for.
struct JudgedMatrix {
  LightMatrix matrix;
  MatrixFigures figures;
};

struct Comparison {
  Light light;
  absl::StatusOr<JudgedMatrix> focused;    // the usual focused shadow map, without a warp
  absl::StatusOr<JudgedMatrix> published;  // Chong and Gortler's Algorithm 1
  absl::StatusOr<JudgedMatrix> final;      // the method asked for
  double final_time_ms = 0;                // for this light on its own, read-back in memory
};

// The yardsticks' options: with the margin of `options`, else as their authors have it.
FitOptions FocusedOptions(const FitOptions& options);
FitOptions PublishedOptions(const FitOptions& options);

Comparison Compare(const Readback& readback,
                   const Light& light,
                   MapSize map,
                   const FitOptions& options);

// The same for a light that could not even be read.
Comparison FailedComparison(const Light& light, const absl::Status& status);

}  // namespace lightfit
