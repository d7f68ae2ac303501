// wire/plan_proto.h
//
// Several maps for one light, from and to lightfit.v1.
// In:   LightPlan, PlanOptions; or their messages, which may come from anywhere.
// Out:  v1::Plan with what a look-up needs; Plan; PlanOptions.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/clip.h"
#include "geometry/light.h"
#include "lightfit/v1/result.pb.h"
#include "partition/fit_plan.h"
#include "partition/plan.h"
#include "partition/plan_options.h"

namespace lightfit {

// `clip` is the convention of every clip_from_world. Median, p99 and worst footprint only
// `with_quantiles`. InvalidArgument when a matrix is not one of the light.
absl::StatusOr<v1::Plan> PlanToProto(const LightPlan& plan,
                                     const Light& light,
                                     const ClipConvention& clip,
                                     double guard_texels,
                                     bool with_quantiles);

// What a look-up needs of it; coarseness follows from the matrices and is not read. `field` names
// the plan in errors.
absl::StatusOr<Plan> PlanFromProto(const v1::Plan& proto, absl::string_view field);

// Of a plan that PlanFromProto() reads: >= 0, and something is left of every map.
absl::StatusOr<double> GuardTexelsFromProto(const v1::Plan& proto, absl::string_view field);

// InvalidArgument where the light has several maps: for who takes one matrix of each light, and
// must not take one of several for it.
absl::Status CheckHasOneMap(const v1::LightResult& light);

// Without PlanOptions::fit, which is FitResult::options.
v1::PlanOptions PlanOptionsToProto(const PlanOptions& options);

// Fields that are absent mean the default. InvalidArgument names the field whose value is out of
// range. `fit` has been validated.
absl::StatusOr<PlanOptions> PlanOptionsFromProto(const v1::PlanOptions& proto,
                                                 const FitOptions& fit);

}  // namespace lightfit
