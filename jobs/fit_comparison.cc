#include "jobs/fit_comparison.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_format.h"
#include "jobs/plan_advice.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/fit_plan.h"
#include "partition/plan_sizes.h"

namespace lightfit {

namespace {

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  const auto now = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::milli>(now - start).count();
}

// Of each light what `compare` says, unless it could not be read.
template <typename Compare>
ComparedReadback CompareEach(const Readback& readback,
                             absl::Span<const Light> lights,
                             absl::Span<const absl::Status> light_status,
                             const SampleOptions& samples,
                             const std::function<void(const Light&)>& before_light,
                             const Compare& compare) {
  ComparedReadback result = {FindSurfaces(readback, LightMask(lights), samples), {}};
  for (size_t i = 0; i < lights.size(); ++i) {
    before_light(lights[i]);
    const absl::Status& status = light_status[i].ok() ? result.surfaces.status() : light_status[i];
    result.comparisons.push_back(status.ok() ? compare(*result.surfaces, lights[i])
                                             : FailedFitComparison(lights[i], status));
  }
  return result;
}

}  // namespace

FitComparison CompareFit(const Surfaces& surfaces,
                         const Light& light,
                         MapSize map,
                         const FitOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<LightMatrix> final = FitLight(surfaces, light, map, options);
  const double time_ms = MillisecondsSince(start);
  if (!final.ok()) {
    return FailedFitComparison(
        light, WithNumMaps(final.status(), surfaces, light, map, options, "options.max_maps"));
  }
  const absl::StatusOr<MatrixJudge> judge =
      MatrixJudge::Of(surfaces, light, final->border, options);
  if (!judge.ok()) return FailedFitComparison(light, judge.status());
  return {light,
          (*judge)(FitLight(surfaces, light, map, FitOptions::Focused(options))),
          (*judge)(FitLight(surfaces, light, map, FitOptions::AsPublished(options))),
          (*judge)(std::move(final)),
          time_ms};
}

FitComparison ComparePlan(const Surfaces& surfaces,
                          const Light& light,
                          const PlanOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<LightPlan> plan = FitPlan(surfaces, light, options);
  const double time_ms = MillisecondsSince(start);
  if (!plan.ok()) return FailedFitComparison(light, plan.status());
  const absl::StatusOr<MatrixJudge> judge =
      MatrixJudge::Of(surfaces, light, plan->border, options.fit);
  if (!judge.ok()) return FailedFitComparison(light, judge.status());
  // Made for the same filter.
  const MapSize map = OneMapSize(options);
  FitOptions one = options.fit;
  one.margin_texels += options.guard_texels;
  return {light,
          (*judge)(FitLight(surfaces, light, map, FitOptions::Focused(one))),
          (*judge)(FitLight(surfaces, light, map, FitOptions::AsPublished(one))),
          (*judge)(FitLight(surfaces, light, map, one)),
          time_ms,
          (*judge)(*std::move(plan), options.guard_texels)};
}

std::string PlanSizeText(const PlanOptions& options) {
  const std::string maps = absl::StrFormat("up to %d maps for each light, ", options.max_maps);
  if (!options.each.has_value()) return absl::StrFormat("%s%d texels in all", maps, options.texels);
  return absl::StrFormat("%s%d x %d texels each", maps, options.each->width, options.each->height);
}

MapSize OneMapSize(const PlanOptions& options) {
  PlanOptions all = options;
  if (options.each.has_value()) {
    all.texels = TexelsOf(*options.each) * options.max_maps;
    all.each.reset();
  }
  return SizeOfOneMap(all);
}

ComparedReadback CompareLights(const Readback& readback,
                               absl::Span<const Light> lights,
                               absl::Span<const absl::Status> light_status,
                               MapSize map,
                               const FitOptions& options,
                               const std::function<void(const Light&)>& before_light) {
  return CompareEach(readback,
                     lights,
                     light_status,
                     options.samples,
                     before_light,
                     [&](const Surfaces& surfaces, const Light& light) {
                       return CompareFit(surfaces, light, map, options);
                     });
}

ComparedReadback CompareLights(const Readback& readback,
                               absl::Span<const Light> lights,
                               absl::Span<const absl::Status> light_status,
                               const PlanOptions& options,
                               const std::function<void(const Light&)>& before_light) {
  return CompareEach(readback,
                     lights,
                     light_status,
                     options.fit.samples,
                     before_light,
                     [&](const Surfaces& surfaces, const Light& light) {
                       return ComparePlan(surfaces, light, options);
                     });
}

FitComparison FailedFitComparison(const Light& light, const absl::Status& status) {
  return {light, status, status, status, 0};
}

}  // namespace lightfit
