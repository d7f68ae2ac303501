#include "partition/fit_plans.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "base/stop.h"

namespace lightfit {

namespace {

absl::Status Validate(absl::Span<const PlannedLight> lights, const PlanOptions& options) {
  for (const PlannedLight& light : lights) {
    if (light.weight > 0.0 && std::isfinite(light.weight)) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": weight = %g, want finite and more than 0", light.light.name, light.weight));
  }
  return ValidateSharedBudget(static_cast<int>(lights.size()), options);
}

}  // namespace

absl::Status ValidateSharedBudget(int num_lights,
                                  const PlanOptions& options,
                                  absl::string_view texels_name) {
  if (options.each.has_value()) return ValidatePlanOptions(options);
  const int64_t num = std::max(1, num_lights);
  PlanOptions most = options;
  most.texels = kMostPlanTexels;
  if (absl::Status status = ValidatePlanOptions(most); !status.ok()) return status;
  const int64_t least = LeastPlanTexels(options), share = options.texels / num;
  if (share >= least && share <= kMostPlanTexels) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s %d, want %d ... %d for %d %s of up to %d maps%s",
                      texels_name,
                      options.texels,
                      least * num,
                      kMostPlanTexels * num,
                      num,
                      num == 1 ? "light" : "lights",
                      options.max_maps,
                      num == 1 ? "" : " each"));
}

LightPlans FitPlans(const Surfaces& surfaces,
                    absl::Span<const PlannedLight> lights,
                    const PlanOptions& options) {
  LightPlans plans(lights.size());
  if (lights.empty()) return plans;
  if (absl::Status status = Validate(lights, options); !status.ok()) {
    return LightPlans(lights.size(), status);
  }
  PlanOptions share = options;
  if (!options.each.has_value()) share.texels /= static_cast<int64_t>(lights.size());
  for (size_t i = 0; i < lights.size(); ++i) {
    plans[i] = FitPlan(surfaces, lights[i].light, share);
  }
  if (options.each.has_value()) return plans;

  // math.md (16) of c k, k = E S^q: from c E, as all have the same S.
  const double exponent = IsL1(options.fit.metric) ? 0.5 : 1.0;
  ScratchVector<double> shares(lights.size(), 0.0);
  double sum = 0.0;
  int num_fitted = 0;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!plans[i].ok()) continue;
    shares[i] = std::pow(lights[i].weight * plans[i]->energy, 1.0 / (1.0 + exponent));
    sum += shares[i];
    ++num_fitted;
  }
  if (num_fitted == 0 || !(sum > 0.0)) return plans;
  const int64_t spare = options.texels - num_fitted * LeastPlanTexels(options.max_maps);
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!plans[i].ok()) continue;
    // The least that a plan may have, and of the rest its share.
    share.texels = LeastPlanTexels(options.max_maps) +
                   static_cast<int64_t>(static_cast<double>(spare) * (shares[i] / sum));
    plans[i] = FitPlan(surfaces, lights[i].light, share);
  }
  return plans;
}

}  // namespace lightfit
