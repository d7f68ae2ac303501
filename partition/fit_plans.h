// partition/fit_plans.h
//
// One budget of texels for the plans of several lights.
// In:   Surfaces, lights, PlanOptions, what each light counts.
// Out:  a LightPlan for each light, with sizes that leave the least energy in all.
//
// A plan of S texels has the energy k S^-q whatever its maps are, math.md (22), so that (16)
// divides the texels among lights as it does among the maps of one. k is that of the plan that each
// light has with an equal share.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"
#include "partition/fit_plan.h"

namespace lightfit {

struct PlannedLight {
  Light light;
  double weight = 1.0;  // what its energy counts in the total; > 0
};

using LightPlans = ScratchVector<absl::StatusOr<LightPlan>>;

// Of so many lights, which PlanOptions::texels are divided among. InvalidArgument names the field;
// `texels_name` is what whoever asks writes before their number.
absl::Status ValidateSharedBudget(int num_lights,
                                  const PlanOptions& options,
                                  absl::string_view texels_name = "options.texels =");

// PlanOptions::texels are those of all lights together; never exceeded. Element i belongs to
// lights[i] and has its own status; a light without a plan leaves its texels to the others. With
// PlanOptions::each every map has that size, and there is nothing to divide. An error that concerns
// all, a weight or option that cannot be used or a budget too small, is returned for every light.
LightPlans FitPlans(const Surfaces& surfaces,
                    absl::Span<const PlannedLight> lights,
                    const PlanOptions& options = {});

}  // namespace lightfit
