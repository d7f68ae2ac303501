#include "jobs/schemes/published.h"

#include <functional>

#include "absl/strings/str_cat.h"
#include "partition/published/equal_maps.h"
#include "partition/published/face_partition.h"
#include "partition/published/light_partition.h"
#include "partition/published/refocused_maps.h"
#include "partition/published/z_partition.h"

namespace lightfit {

namespace {

using PlanMaker = std::function<absl::StatusOr<Plan>(const MethodInput&)>;

MethodInput InputOf(const SchemeInput& input, MapSize map) {
  MethodInput method = input.view;
  method.light = input.light;
  method.map = map;
  return method;
}

Scheme SchemeOf(const std::string& name, const SchemeBudget& budget, const PlanMaker& make) {
  return {name, [budget, make](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
            absl::StatusOr<Plan> plan = make(InputOf(input, budget.map));
            if (!plan.ok()) return plan.status();
            return SchemeMaps{*std::move(plan), budget.guard_texels};
          }};
}

}  // namespace

Scheme MethodScheme(Method method, const SchemeBudget& budget) {
  return {
      MethodName(method), [method, budget](const SchemeInput& input) -> absl::StatusOr<SchemeMaps> {
        const absl::StatusOr<MethodMap> map = SetUpMap(method, InputOf(input, budget.map));
        if (!map.ok()) return map.status();
        // Exactly the method's own where there is no filter to make room for.
        const Eigen::Matrix4d map_from_world =
            budget.guard_texels > 0.0
                ? WithMargin(map->map_from_world, budget.map, budget.guard_texels)
                : map->map_from_world;
        return SchemeMaps{PlanOfOneMap(input.light.name, map_from_world, budget.map, Border::kLit),
                          budget.guard_texels,
                          map->note};
      }};
}

std::string SlicesName(Method method, int num_maps) {
  if (method == Method::kFocused) return absl::StrCat("ZP", num_maps);
  const char* name = method == Method::kLispsm ? "LiSPSM" : MethodName(method);
  return absl::StrCat("ZP", num_maps, "+", name);
}

Scheme SlicesScheme(Method method, PlanShapes shapes, const SchemeBudget& budget) {
  ZPartitionOptions options;
  options.num_maps = budget.num_maps;
  options.method = method;
  options.shapes = shapes;
  options.margin_texels = budget.guard_texels;
  std::string name = SlicesName(method, budget.num_maps);
  if (shapes == PlanShapes::kAspects) absl::StrAppend(&name, ", aspects");
  return SchemeOf(
      name, budget, [options](const MethodInput& input) { return ZPartition(input, options); });
}

std::vector<Scheme> SlicesSchemes(const SchemeBudget& budget) {
  std::vector<Scheme> schemes;
  for (const Method method : {Method::kLispsm, Method::kFocused}) {
    for (const PlanShapes shapes : {PlanShapes::kEqualSquares, PlanShapes::kAspects}) {
      schemes.push_back(SlicesScheme(method, shapes, budget));
    }
  }
  return schemes;
}

std::vector<Scheme> PublishedSchemes(const SchemeBudget& budget) {
  ZPartitionOptions parallel_split;
  parallel_split.num_maps = budget.num_maps;
  parallel_split.log_share = 0.5;
  parallel_split.method = Method::kFocused;
  parallel_split.margin_texels = budget.guard_texels;
  FacePartitionOptions faces;
  faces.margin_texels = budget.guard_texels;
  LightPartitionOptions rectangles;
  rectangles.margin_texels = budget.guard_texels;
  RefocusOptions sides;
  sides.margin_texels = budget.guard_texels;
  return {SchemeOf(absl::StrCat("PSSM", budget.num_maps),
                   budget,
                   [parallel_split](const MethodInput& input) {
                     return ZPartition(input, parallel_split);
                   }),
          SchemeOf("FP+ZP+W",
                   budget,
                   [faces](const MethodInput& input) { return FacePartition(input, faces); }),
          SchemeOf("Tang",
                   budget,
                   [rectangles](const MethodInput& input) {
                     return LightPartitionPlan(input, rectangles);
                   }),
          SchemeOf("Mikkelsen", budget, [sides](const MethodInput& input) {
            return SeparatingPlanePlan(input, sides);
          })};
}

}  // namespace lightfit
