#include "bench/plan_rows.h"

#include "absl/strings/str_cat.h"
#include "partition/fit_plan.h"
#include "partition/published/face_partition.h"
#include "partition/published/light_partition.h"
#include "partition/published/refocused_maps.h"
#include "partition/published/z_partition.h"
#include "partition/shipped/sample_distribution.h"
#include "partition/shipped/stable_cascades.h"

namespace lightfit {

namespace {

using Kind = PlanRow::Kind;

MethodInput InputOf(const PlanInputs& inputs) {
  MethodInput input = inputs.method;
  input.light = inputs.light;
  input.map = kPlanMap;
  return input;
}

PlanRow FittedRow(const std::string& name, Kind kind, bool from_large, const PlanOptions& options) {
  return {name, kind, from_large, {[from_large, options](const PlanInputs& inputs) {
            const absl::StatusOr<LightPlan> plan =
                FitPlan(from_large ? inputs.large : inputs.small, inputs.light, options);
            return plan.ok() ? absl::StatusOr<Plan>(PlanOf(*plan)) : plan.status();
          }}};
}

PlanRow MethodRow(Method method) {
  return {MethodName(method),
          Kind::kOneMap,
          false,
          {[method](const PlanInputs& inputs) -> absl::StatusOr<Plan> {
            const absl::StatusOr<MethodMap> map = SetUpMap(method, InputOf(inputs));
            if (!map.ok()) return map.status();
            Plan plan;
            plan.maps.emplace_back();
            plan.maps[0].map_from_world = map->map_from_world;
            plan.maps[0].size = kPlanMap;
            return plan;
          }}};
}

// Slices at equal ratios of depth, in squares and in Lloyd's aspects.
PlanRow SlicesRow(const std::string& name, int num_maps, Method method) {
  PlanRow row = {name, Kind::kPublished, false, {}};
  for (const PlanShapes shapes : {PlanShapes::kEqualSquares, PlanShapes::kAspects}) {
    ZPartitionOptions options;
    options.num_maps = num_maps;
    options.method = method;
    options.shapes = shapes;
    row.make.push_back(
        [options](const PlanInputs& inputs) { return ZPartition(InputOf(inputs), options); });
  }
  return row;
}

PlanRow PublishedRow(const std::string& name, const PlanRow::Make& make) {
  return {name, Kind::kPublished, false, {make}};
}

}  // namespace

std::vector<PlanRow> MakePlanRows(const std::vector<int>& num_maps,
                                  int small_side,
                                  int large_side) {
  PlanOptions one;
  one.max_maps = 1;
  one.texels = kPlanTexels;
  PlanOptions chosen = one;
  chosen.fit.border = BorderChoice::kAutomatic;
  PlanOptions as_published = one;
  as_published.fit = FitOptions::AsPublished();
  as_published.fit.sample_by_sample = false;
  std::vector<PlanRow> rows = {
      FittedRow("one map", Kind::kOneMap, false, one),
      FittedRow("one, border chosen", Kind::kOneMap, false, chosen),
      FittedRow("as published", Kind::kOneMap, false, as_published),
      SlicesRow("ZP4+LiSPSM", 4, Method::kLispsm),
      SlicesRow("ZP4", 4, Method::kFocused),
      PublishedRow("PSSM4",
                   [](const PlanInputs& inputs) {
                     ZPartitionOptions options;
                     options.log_share = 0.5;
                     options.method = Method::kFocused;
                     return ZPartition(InputOf(inputs), options);
                   }),
      PublishedRow("FP+ZP+W",
                   [](const PlanInputs& inputs) { return FacePartition(InputOf(inputs)); }),
      PublishedRow(
          "Tang", [](const PlanInputs& inputs) { return LightPartitionPlan(InputOf(inputs), {}); }),
      PublishedRow(
          "Mikkelsen",
          [](const PlanInputs& inputs) { return SeparatingPlanePlan(InputOf(inputs), {}); }),
      PublishedRow("stable4",
                   [](const PlanInputs& inputs) {
                     return StableCascades(inputs.light, inputs.method.camera, kPlanTexels, {});
                   }),
      PublishedRow("SDSM4",
                   [](const PlanInputs& inputs) {
                     return SampleDistributionMaps(inputs.small, inputs.light, kPlanTexels, {});
                   }),
      MethodRow(Method::kFocused),
      MethodRow(Method::kLispsm),
      FittedRow(absl::StrCat("one map, ", large_side), Kind::kOneMap, true, one)};
  for (const bool from_large : {false, true}) {
    const int side = from_large ? large_side : small_side;
    for (const int count : num_maps) {
      PlanOptions plan = one;
      plan.max_maps = count;
      const std::string name = absl::StrCat(count, " maps, ", side);
      rows.push_back(FittedRow(name, Kind::kOurs, from_large, plan));
      plan.fit.border = BorderChoice::kAutomatic;
      rows.push_back(FittedRow(absl::StrCat(name, ", chosen"), Kind::kOurs, from_large, plan));
    }
  }
  // One size for all, as in an array of textures; and without a choice among fewer.
  PlanOptions equal = one;
  equal.max_maps = 4;
  equal.each = MapSize{200, 200};
  equal.choose_by_forecast = false;
  rows.push_back(FittedRow(absl::StrCat("4 squares, ", large_side), Kind::kOurs, true, equal));
  PlanOptions all = one;
  all.max_maps = 4;
  all.choose_by_forecast = false;
  rows.push_back(FittedRow(absl::StrCat("4 in any case, ", small_side), Kind::kOurs, false, all));
  return rows;
}

}  // namespace lightfit
