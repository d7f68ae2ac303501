// jobs/fit_comparison.h
//
// One light fitted by the method asked for, beside the two methods that people know.
#pragma once

#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// A matrix with its figures, foretold wrong pixels among them.
struct JudgedMatrix {
  LightMatrix matrix;
  Figures figures;      // over the samples that all tables are over: FigureOptions()
  Figures own_figures;  // over the samples of the fit that was asked for, for its result file
};

struct FitComparison {
  Light light;
  absl::StatusOr<JudgedMatrix> focused;    // the usual focused shadow map, without a warp
  absl::StatusOr<JudgedMatrix> published;  // Chong and Gortler's Algorithm 1
  absl::StatusOr<JudgedMatrix> final;      // the method asked for
  double final_time_ms = 0;  // for this light; the surfaces of the read-back are found once for all
};

// What every table's figures are over, whichever way a matrix was made: the samples that a fit
// takes by default (SampleOptions), in the metric of `options`.
FitOptions FigureOptions(const FitOptions& options);

// `light` of the surfaces' read-back, which must have been found for it.
FitComparison CompareFit(const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options);

// All lights of a read-back, whose surfaces are found once. `light_status[l]` belongs to lights[l]:
// ok, or why its shadow could not be read. An error that concerns the whole read-back is every
// light's, and that of `surfaces`.
struct ComparedReadback {
  absl::StatusOr<Surfaces> surfaces;
  std::vector<FitComparison> comparisons;
};
ComparedReadback CompareLights(const Readback& readback,
                               absl::Span<const Light> lights,
                               absl::Span<const absl::Status> light_status,
                               MapSize map,
                               const FitOptions& options,
                               const std::function<void(const Light&)>& before_light);

// The same for a light that could not even be read.
FitComparison FailedFitComparison(const Light& light, const absl::Status& status);

}  // namespace lightfit
