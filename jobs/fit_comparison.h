// jobs/fit_comparison.h
//
// One light fitted by the method asked for, beside the two methods that people know; or its plan of
// several maps, beside single maps of as many texels.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "jobs/matrix_judge.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan_options.h"

namespace lightfit {

struct FitComparison {
  Light light;
  absl::StatusOr<JudgedMatrix> focused;    // the usual focused shadow map, without a warp
  absl::StatusOr<JudgedMatrix> published;  // Chong and Gortler's Algorithm 1
  absl::StatusOr<JudgedMatrix> final;      // the method asked for
  double final_time_ms = 0;  // for this light; the surfaces of the read-back are found once for all

  // Where plans were asked for: the light's answer. The others are then single maps of the texels
  // that all maps of the plan may have together, and the time is the plan's.
  std::optional<absl::StatusOr<JudgedPlan>> plan = std::nullopt;

  // Whether the light has its answer, and what is said of it whether plan or matrix.
  const absl::Status& status() const { return plan.has_value() ? plan->status() : final.status(); }
  bool ok() const { return status().ok(); }
  Border border() const { return plan ? (*plan)->plan.border : final->matrix.border; }
  const Figures& figures() const { return plan ? (*plan)->figures : final->figures; }
  const SampleCounts& samples() const {
    return plan ? (*plan)->own_figures.samples : final->matrix.figures.samples;
  }
};

// `light` of the surfaces' read-back, which must have been found for it. Where receivers surround
// it the error says how many maps a plan would take.
FitComparison CompareFit(const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options);

// The same for its plan; the error is the plan's.
FitComparison ComparePlan(const Surfaces& surfaces, const Light& light, const PlanOptions& options);

// "up to 4 maps for each light, 1048576 texels in all" or "..., 512 x 512 texels each".
std::string PlanSizeText(const PlanOptions& options);

// The single map that a plan is compared with: square, of no more texels than the plan may have.
MapSize OneMapSize(const PlanOptions& options);

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
ComparedReadback CompareLights(const Readback& readback,
                               absl::Span<const Light> lights,
                               absl::Span<const absl::Status> light_status,
                               const PlanOptions& options,
                               const std::function<void(const Light&)>& before_light);

// The same for a light that could not even be read.
FitComparison FailedFitComparison(const Light& light, const absl::Status& status);

}  // namespace lightfit
