#include "jobs/schemes/shipped.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "optimizer/readback/samples.h"
#include "partition/published/equal_maps.h"
#include "partition/shipped/paraboloid_plane.h"
#include "partition/shipped/sample_distribution.h"
#include "partition/shipped/stable_cascades.h"

namespace lightfit {

namespace {

// In light space, world axes, as the samples of directions are made from.
Samples LightSamples(const Surfaces& surfaces, const Light& light) {
  const FacingSource facing = surfaces.readback.FacingOf(light.shadow_bit);
  return SelectSamples(surfaces, light, SampleOptions(), Eigen::Matrix3d::Identity(), true, facing);
}

absl::StatusOr<SchemeMaps> MapsOf(absl::StatusOr<Plan> plan, double guard_texels) {
  if (!plan.ok()) return plan.status();
  return SchemeMaps{*std::move(plan), guard_texels};
}

}  // namespace

std::vector<Scheme> CascadeSchemes(const SchemeBudget& budget) {
  const auto stable = [budget](const SchemeInput& input) {
    StableCascadesOptions options;
    options.num_maps = budget.num_maps;
    options.margin_texels = budget.guard_texels;
    return MapsOf(StableCascades(input.light, input.view.camera, budget.texels(), options),
                  budget.guard_texels);
  };
  // The paper's boxes have no room for filters.
  const auto by_samples = [budget](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
    if (!input.surfaces.ok()) return input.surfaces.status();
    SampleDistributionOptions options;
    options.num_maps = budget.num_maps;
    absl::StatusOr<Plan> plan =
        SampleDistributionMaps(*input.surfaces, input.light, budget.texels(), options);
    if (plan.ok() && budget.guard_texels > 0.0) {
      for (PlanMap& map : plan->maps) {
        map.map_from_world = WithMargin(map.map_from_world, map.size, budget.guard_texels);
      }
    }
    return MapsOf(std::move(plan), budget.guard_texels);
  };
  return {{absl::StrCat("stable", budget.num_maps), stable},
          {absl::StrCat("SDSM", budget.num_maps), by_samples}};
}

Scheme PagesScheme(const std::string& name, const SchemeBudget& budget) {
  return {name, [budget](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            if (!input.surfaces.ok()) return input.surfaces.status();
            constexpr int kLeastPages = 4;
            ClipmapOptions options;
            while (options.page_side > 8 &&
                   int64_t{kLeastPages} * options.page_side * options.page_side > budget.texels()) {
              options.page_side /= 2;
            }
            absl::StatusOr<PagedMap> pages =
                ClipmapPages(*input.surfaces, input.light, budget.texels(), options);
            if (!pages.ok()) return pages.status();
            return SchemeMaps{*std::move(pages)};
          }};
}

Scheme CubeScheme(const std::string& name,
                  const CubeFacesOptions& options,
                  const SchemeBudget& budget) {
  return {name, [budget, options](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            if (!input.surfaces.ok()) return input.surfaces.status();
            const Samples samples = options.turned && input.light.kind == Light::Kind::kPoint
                                        ? LightSamples(*input.surfaces, input.light)
                                        : Samples();
            return MapsOf(
                CubeFaces(*input.surfaces, input.light, samples, budget.texels(), options), 0.0);
          }};
}

Scheme PairScheme(const std::string& name,
                  const std::optional<Eigen::Vector3d>& normal,
                  PairFill fill,
                  const SchemeBudget& budget) {
  return {name, [budget, normal, fill](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            if (!input.surfaces.ok()) return input.surfaces.status();
            Eigen::Vector3d axis = normal.value_or(Eigen::Vector3d::UnitZ());
            if (!normal.has_value() && input.light.kind == Light::Kind::kPoint) {
              const Samples samples = LightSamples(*input.surfaces, input.light);
              axis = BestParaboloidPlane(DirectionSamples(input.light, samples)).normal;
            }
            absl::StatusOr<ParaboloidPair> pair =
                MakeParaboloidPair(input.light, axis, budget.texels());
            if (!pair.ok()) return pair.status();
            if (fill == PairFill::kByRaster) return SchemeMaps{RasterisedPair{*std::move(pair)}};
            return SchemeMaps{*std::move(pair)};
          }};
}

std::vector<Scheme> ShippedSchemes(const SchemeBudget& budget) {
  std::vector<Scheme> schemes = CascadeSchemes(budget);
  CubeFacesOptions turned;
  turned.turned = true;
  for (Scheme& scheme : std::vector<Scheme>{
           PagesScheme("pages", budget),
           CubeScheme("cube", {}, budget),
           CubeScheme("cube, turned", turned, budget),
           PairScheme("paraboloids", std::nullopt, PairFill::kByRays, budget),
           PairScheme("paraboloids, drawn", std::nullopt, PairFill::kByRaster, budget)}) {
    schemes.push_back(std::move(scheme));
  }
  return schemes;
}

}  // namespace lightfit
