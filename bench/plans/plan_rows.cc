#include "bench/plans/plan_rows.h"

#include "absl/strings/str_cat.h"
#include "jobs/schemes/fitted.h"
#include "jobs/schemes/published.h"
#include "jobs/schemes/shipped.h"

namespace lightfit {

namespace {

using Kind = PlanRow::Kind;

// What engines have for virtual shadow maps, rather than what a single map has.
constexpr MapSize kPagePool = {2048, 2048};

PlanRow FittedRow(const std::string& name, Kind kind, bool from_large, const PlanOptions& options) {
  return {name, kind, from_large, {FittedScheme(name, options)}};
}

PlanRow RowOf(Kind kind, const Scheme& scheme) { return {scheme.name, kind, false, {scheme}}; }

// Slices at equal ratios of depth, in squares and in Lloyd's aspects.
PlanRow SlicesRow(Method method, const SchemeBudget& budget) {
  PlanRow row = {SlicesName(method, budget.num_maps), Kind::kPublished, false, {}};
  for (const PlanShapes shapes : {PlanShapes::kEqualSquares, PlanShapes::kAspects}) {
    row.schemes.push_back(SlicesScheme(method, shapes, budget));
  }
  return row;
}

void AddOurs(const std::vector<int>& num_maps,
             int small_side,
             int large_side,
             const PlanOptions& one,
             std::vector<PlanRow>* rows) {
  for (const bool from_large : {false, true}) {
    const int side = from_large ? large_side : small_side;
    for (const int count : num_maps) {
      PlanOptions plan = one;
      plan.max_maps = count;
      const std::string name = absl::StrCat(count, " maps, ", side);
      rows->push_back(FittedRow(name, Kind::kOurs, from_large, plan));
      plan.fit.border = BorderChoice::kAutomatic;
      rows->push_back(FittedRow(absl::StrCat(name, ", chosen"), Kind::kOurs, from_large, plan));
    }
  }
  // One size for all, as in an array of textures; and without a choice among fewer.
  PlanOptions equal = one;
  equal.max_maps = 4;
  equal.each = MapSize{200, 200};
  equal.choose_by_forecast = false;
  rows->push_back(FittedRow(absl::StrCat("4 squares, ", large_side), Kind::kOurs, true, equal));
  PlanOptions all = one;
  all.max_maps = 4;
  all.choose_by_forecast = false;
  rows->push_back(FittedRow(absl::StrCat("4 in any case, ", small_side), Kind::kOurs, false, all));
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
  const SchemeBudget budget = {kPlanMap, 4};
  std::vector<PlanRow> rows = {FittedRow("one map", Kind::kOneMap, false, one),
                               FittedRow("one, border chosen", Kind::kOneMap, false, chosen),
                               FittedRow("as published", Kind::kOneMap, false, as_published),
                               SlicesRow(Method::kLispsm, budget),
                               SlicesRow(Method::kFocused, budget)};
  for (const Scheme& scheme : PublishedSchemes(budget)) {
    rows.push_back(RowOf(Kind::kPublished, scheme));
  }
  for (const Scheme& scheme : ShippedSchemes(budget)) {
    rows.push_back(RowOf(Kind::kPublished, scheme));
  }
  PlanRow pool =
      RowOf(Kind::kMoreTexels, PagesScheme(absl::StrCat("pages, ", kPagePool.width), {kPagePool}));
  pool.texels = int64_t{kPagePool.width} * kPagePool.height;
  rows.push_back(pool);
  for (const Method method : {Method::kFocused, Method::kLispsm}) {
    rows.push_back(RowOf(Kind::kOneMap, MethodScheme(method, budget)));
  }
  rows.push_back(FittedRow(absl::StrCat("one map, ", large_side), Kind::kOneMap, true, one));
  AddOurs(num_maps, small_side, large_side, one, &rows);
  return rows;
}

}  // namespace lightfit
