#include "calls/request_plans.h"

#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/map_size.h"
#include "jobs/matrix_judge.h"
#include "partition/fit_plan.h"
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
  // A light's share is what its plan may have, and is looked at below.
  constexpr int64_t kMostTexels = int64_t{kMaxMapSide} * kMaxMapSide;
  given.set_texels(kMostTexels);
  absl::StatusOr<PlanOptions> options = PlanOptionsOf(given, request.options(), fit, limits);
  if (!options.ok()) return options.status();
  options->texels = budget;
  const int64_t least = LeastPlanTexels(*options);
  if (num_lights > 0 && (budget / num_lights < least || budget / num_lights > kMostTexels)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("budget_texels = %d, want %d ... %d for %d lights of up to %d maps each",
                        budget,
                        least * num_lights,
                        kMostTexels * num_lights,
                        num_lights,
                        options->max_maps));
  }
  return std::optional<PlanOptions>(*options);
}

absl::Status CheckServesPlans(const Readback& readback) {
  if (readback.fine_cover == nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "readback.fine_cover: plans do not look at it yet; leave it out, or leave out plan_options");
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
  fit.matrix = plan->maps[0];  // the answer where it is the only one
  fit.wrong_share = figures->wrong_share;
  fit.plan = PlanFit{*std::move(plan), *figures, options.guard_texels};
  return fit;
}

}  // namespace lightfit
