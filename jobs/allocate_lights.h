// jobs/allocate_lights.h
//
// Sizes and matrices of the maps of several lights, for the service and for the command line.
// In:   lights with a read-back or with summaries, a budget of texels or a tolerance.
// Out:  AllocationReport: every light's fit at the size found for it, beside its yardsticks.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "optimizer/readback/readback.h"
#include "partition/plan_options.h"
#include "wire/allocation_json.h"
#include "wire/summary_set.h"

namespace lightfit {

struct AllocationTask {
  std::vector<Light> lights;
  FitOptions options;  // of summaries: OptionsForSummaries()

  // One of the two; element l of theirs belongs to lights[l].
  std::optional<Readback> readback;
  std::optional<SummarySet> summaries;

  // With a read-back: ok, or why a light has no shadow there.
  std::vector<absl::Status> light_status;

  // One of the two.
  std::optional<int64_t> budget_texels;
  std::optional<Tolerance> tolerance;

  std::vector<double> weights;  // with a budget; element l belongs to lights[l]
  MapSizeRules rules;

  // With a budget and a read-back: several maps for each light, which the budget is divided among;
  // PlanOptions::texels is the budget, and of sizes PlanOptions::sizes counts.
  std::optional<PlanOptions> plans;
};

// Called as each step begins, with words such as "fitting sun". A budget takes two steps for each
// light, a tolerance one.
using StepCallback = std::function<void(const std::string& what)>;

// Source and clip of the report are the caller's to fill in. A light without a map has its own
// status. Errors are those of AllocateBudget().
absl::StatusOr<AllocationReport> AllocateLights(const AllocationTask& task,
                                                const StepCallback& begin_step);

// As AllocationToProto(), and of summaries without what only a read-back can tell.
v1::Allocation AllocationMessage(const AllocationReport& report, bool of_summaries);

}  // namespace lightfit
