// calls/request_plans.h
//
// Several maps for each light, where a request asks for them.
// In:   v1::PlanOptions beside the fields that they take the place of.
// Out:  PlanOptions; or plans of the request's lights.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "calls/request_lights.h"
#include "lightfit/v1/options.pb.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan_options.h"
#include "wire/result_json.h"

namespace lightfit {

// `given` are options as the request has them, `fit` the same as understood. InvalidArgument names
// the field; ResourceExhausted above limits.max_maps.
absl::StatusOr<PlanOptions> PlanOptionsOf(const v1::PlanOptions& proto,
                                          const v1::FitOptions& given,
                                          const FitOptions& fit,
                                          const CallLimits& limits);

// The same of a FitRequest or TrackSetup; nothing where it wants one map for each light.
template <typename Request>
absl::StatusOr<std::optional<PlanOptions>> PlanOptionsOfRequest(const Request& request,
                                                                const FitOptions& fit,
                                                                const CallLimits& limits) {
  if (!request.has_plan_options()) return std::optional<PlanOptions>();
  if (request.has_map()) {
    return absl::InvalidArgumentError(
        "map: does not go with plan_options; want plan_options.texels, or plan_options.each for "
        "maps of one size");
  }
  const absl::StatusOr<PlanOptions> options =
      PlanOptionsOf(request.plan_options(), request.options(), fit, limits);
  if (!options.ok()) return options.status();
  return std::optional<PlanOptions>(*options);
}

// The same of an AllocateRequest, which divides a budget among the plans of `num_lights` lights;
// nothing where it wants one map for each. InvalidArgument also for what plans do not go with, and
// for a budget that is too small for so many.
absl::StatusOr<std::optional<PlanOptions>> PlanOptionsOfBudget(const v1::AllocateRequest& request,
                                                               const FitOptions& fit,
                                                               int num_lights,
                                                               const CallLimits& limits);

// A light's plan and its figures; the forecast only where `foretells`. As `lightfit fit --maps`.
LightFit PlanFitOf(const RequestLight& light,
                   const Surfaces& surfaces,
                   const PlanOptions& options,
                   bool foretells);

}  // namespace lightfit
