#include "calls/request_plans.h"

#include <utility>

#include "absl/strings/str_format.h"
#include "jobs/matrix_judge.h"
#include "partition/fit_plan.h"
#include "partition/fit_plans.h"
#include "wire/plan_proto.h"

namespace lightfit {

absl::StatusOr<PlanOptions> PlanOptionsOf(const v1::PlanOptions& proto,
                                          const v1::FitOptions& given,
                                          const FitOptions& fit,
                                          const CallLimits& limits) {
  const FitOptions defaults;
  if (fit.search != defaults.search) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.search = %s: the maps of a plan are searched in one way; leave it "
                        "unspecified, or leave out plan_options",
                        v1::Search_Name(given.search())));
  }
  if (fit.affine != defaults.affine) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.affine = %s: the maps of a plan are parallelograms of least "
                        "energy; leave it unspecified, or leave out plan_options",
                        v1::Affine_Name(given.affine())));
  }
  absl::StatusOr<PlanOptions> options = PlanOptionsFromProto(proto, fit);
  if (!options.ok()) return options.status();
  if (options->max_maps > limits.max_maps) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "plan_options.max_maps = %d, and this server takes at most %d; want so many or fewer",
        options->max_maps,
        limits.max_maps));
  }
  return options;
}

absl::StatusOr<std::optional<PlanOptions>> PlanOptionsOfBudget(const v1::AllocateRequest& request,
                                                               const FitOptions& fit,
                                                               int num_lights,
                                                               const CallLimits& limits) {
  if (!request.has_plan_options()) return std::optional<PlanOptions>();
  if (request.goal_case() != v1::AllocateRequest::kBudgetTexels) {
    return absl::InvalidArgumentError(
        "plan_options: plans divide a budget, and a tolerance is for single maps; want "
        "budget_texels, or leave out plan_options");
  }
  if (request.has_rules()) {
    return absl::InvalidArgumentError(
        "rules: do not go with plan_options; want plan_options.sizes, or leave them out for any "
        "sizes");
  }
  v1::PlanOptions given = request.plan_options();
  const int64_t budget = request.budget_texels();
  // What a result says of its options may be asked for again.
  if (given.has_texels() && given.texels() != budget) {
    return absl::InvalidArgumentError(
        absl::StrFormat("plan_options.texels = %d: budget_texels = %d is what all maps of all "
                        "lights have together; leave texels out",
                        given.texels(),
                        budget));
  }
  if (given.has_each()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("plan_options.each = %dx%d: sizes are what a budget is divided into; want "
                        "plan_options.sizes, or leave it out",
                        given.each().width(),
                        given.each().height()));
  }
  // A light's share is what its plan may have.
  given.set_texels(kMostPlanTexels);
  absl::StatusOr<PlanOptions> options = PlanOptionsOf(given, request.options(), fit, limits);
  if (!options.ok()) return options.status();
  options->texels = budget;
  absl::Status status = ValidateSharedBudget(num_lights, *options, "budget_texels =");
  if (!status.ok()) return status;
  return std::optional<PlanOptions>(*options);
}

LightFit PlanFitOf(const RequestLight& light,
                   const Surfaces& surfaces,
                   const PlanOptions& options,
                   bool foretells) {
  LightFit fit;
  fit.light = light.light;
  absl::StatusOr<LightPlan> plan = FitPlan(surfaces, light.light, options);
  if (!plan.ok()) {
    fit.matrix = plan.status();
    return fit;
  }
  const absl::StatusOr<Figures> figures =
      OwnFiguresOf(*plan, surfaces, light.light, options, foretells);
  if (!figures.ok()) {
    fit.matrix = figures.status();
    return fit;
  }
  SetPlan(*std::move(plan), *figures, options.guard_texels, &fit);
  return fit;
}

}  // namespace lightfit
