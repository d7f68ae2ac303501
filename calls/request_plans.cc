#include "calls/request_plans.h"

#include <utility>

#include "absl/strings/str_format.h"
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
