#include "jobs/allocate_lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/map_size.h"
#include "jobs/fit_summary.h"
#include "jobs/matrix_judge.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"
#include "partition/fit_plans.h"

namespace lightfit {
namespace {

// Adds a light's map and how it came about, with the wrong pixels that its matrix will have, where
// it has one and there is a read-back.
void AddLight(const AllocationTask& task,
              const Surfaces* surfaces,
              const Light& light,
              absl::StatusOr<LightMatrix> matrix,
              const AllocationEntry& entry,
              AllocationReport* report) {
  LightFit& fit = report->fit.lights.emplace_back();
  report->entries.push_back(entry);
  fit.light = light;
  fit.matrix = std::move(matrix);
  if (!fit.matrix.ok() || surfaces == nullptr) return;
  const absl::StatusOr<double> wrong_share = ForetellWrongShare(surfaces->readback,
                                                                light,
                                                                fit.matrix->map_from_world,
                                                                fit.matrix->map,
                                                                task.options.samples,
                                                                fit.matrix->border);
  if (wrong_share.ok()) fit.wrong_share = *wrong_share;
}

MapSize EqualSquare(int64_t budget_texels, size_t num_maps) {
  const double share = static_cast<double>(budget_texels) / static_cast<double>(num_maps);
  const int side = static_cast<int>(std::min(std::sqrt(share), static_cast<double>(kMaxMapSide)));
  return {std::max(side, 1), std::max(side, 1)};
}

// What is known of light i: its view in the read-back, or nothing but its summary.
absl::StatusOr<LightView> ViewOf(const AllocationTask& task, const Surfaces& surfaces, size_t i) {
  if (!task.light_status[i].ok()) return task.light_status[i];
  const FitOptions options =
      task.tolerance.has_value() ? ToleranceOptions(task.options) : task.options;
  return ViewLight(surfaces, task.lights[i], options);
}

// The budget's split, light by light.
absl::Status SplitBudget(const AllocationTask& task,
                         const Surfaces* surfaces,
                         const StepCallback& begin_step,
                         AllocationReport* report) {
  std::vector<absl::StatusOr<LightView>> views;
  std::vector<AllocationLight> lights;
  for (size_t i = 0; i < task.lights.size(); ++i) {
    begin_step(absl::StrCat("summing up ", task.lights[i].name));
    views.push_back(surfaces != nullptr ? ViewOf(task, *surfaces, i)
                                        : absl::UnknownError("no read-back"));
    absl::StatusOr<Summary> summary = absl::UnknownError("not summed up");
    if (surfaces == nullptr) {
      summary = SummaryOf(task.summaries->lights[i]);
    } else if (views[i].ok()) {
      summary = SummarizeForAnyAspect(*views[i], task.options);
    } else {
      summary = views[i].status();
    }
    lights.push_back({task.lights[i], std::move(summary), task.weights[i]});
  }
  const absl::StatusOr<Allocation> allocation =
      AllocateBudget(lights, *task.budget_texels, task.rules, task.options);
  if (!allocation.ok()) return allocation.status();
  // From the read-back itself where there is one.
  const auto fit_map = [&](size_t i, MapSize map) {
    return surfaces != nullptr ? FitLight(*views[i], map, task.options)
                               : Fit(*lights[i].summary, lights[i].light, map, task.options);
  };
  size_t num_maps = 0;
  for (const AllocatedMap& map : allocation->maps) num_maps += map.matrix.ok() ? 1 : 0;
  for (size_t i = 0; i < lights.size(); ++i) {
    begin_step(absl::StrCat("fitting ", lights[i].light.name));
    absl::StatusOr<LightMatrix> matrix = allocation->maps[i].matrix;
    AllocationEntry entry;
    entry.weight = lights[i].weight;
    if (matrix.ok()) {
      matrix = fit_map(i, matrix->map);
      const MapSize equal = EqualSquare(*task.budget_texels, num_maps);
      const absl::StatusOr<LightMatrix> square = fit_map(i, equal);
      if (square.ok()) entry.equal_split_energy = square->figures.energy;
    }
    AddLight(task, surfaces, lights[i].light, std::move(matrix), entry, report);
  }
  return absl::OkStatus();
}

// The figures of a light's plan; what a plan of an equal share of the budget would have.
void AddPlan(const AllocationTask& task,
             const Surfaces& surfaces,
             size_t i,
             absl::StatusOr<LightPlan> plan,
             size_t num_plans,
             AllocationReport* report) {
  LightFit& fit = report->fit.lights.emplace_back();
  AllocationEntry& entry = report->entries.emplace_back();
  fit.light = task.lights[i];
  entry.weight = task.weights[i];
  if (!plan.ok()) {
    fit.matrix = plan.status();
    return;
  }
  const absl::StatusOr<MatrixJudge> judge =
      MatrixJudge::Of(surfaces, task.lights[i], plan->border, task.options);
  if (!judge.ok()) {
    fit.matrix = judge.status();
    return;
  }
  const double guard_texels = task.plans->guard_texels;
  const absl::StatusOr<JudgedPlan> judged = (*judge)(*std::move(plan), guard_texels);
  if (!judged.ok()) {
    fit.matrix = judged.status();
    return;
  }
  SetPlan(judged->plan, judged->own_figures, guard_texels, &fit);
  PlanOptions share = *task.plans;
  share.texels = *task.budget_texels / static_cast<int64_t>(num_plans);
  // In the same border, as energies are of the edges that it serves.
  share.fit.border =
      judged->plan.border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
  absl::StatusOr<LightPlan> equal = FitPlan(surfaces, task.lights[i], share);
  if (!equal.ok()) return;
  const absl::StatusOr<JudgedPlan> equal_judged = (*judge)(*std::move(equal), guard_texels);
  if (equal_judged.ok()) entry.equal_split_energy = equal_judged->own_figures.energy;
}

// The budget's division among lights and maps.
void DivideAmongPlans(const AllocationTask& task,
                      const Surfaces& surfaces,
                      const StepCallback& begin_step,
                      AllocationReport* report) {
  std::vector<PlannedLight> lights;
  std::vector<size_t> planned;  // their places among the lights
  begin_step("dividing the texels");
  for (size_t i = 0; i < task.lights.size(); ++i) {
    if (!task.light_status[i].ok()) continue;
    lights.push_back({task.lights[i], task.weights[i]});
    planned.push_back(i);
  }
  LightPlans plans = FitPlans(surfaces, lights, *task.plans);
  size_t num_plans = 0;
  for (const absl::StatusOr<LightPlan>& plan : plans) num_plans += plan.ok() ? 1 : 0;
  size_t next = 0;
  for (size_t i = 0; i < task.lights.size(); ++i) {
    begin_step(absl::StrCat("judging ", task.lights[i].name));
    const bool has_plan = next < planned.size() && planned[next] == i;
    AddPlan(task,
            surfaces,
            i,
            has_plan ? std::move(plans[next++]) : task.light_status[i],
            num_plans,
            report);
  }
}

absl::StatusOr<ToleranceMap> SmallestMap(const AllocationTask& task,
                                         const Surfaces* surfaces,
                                         size_t i) {
  if (surfaces == nullptr) {
    const absl::StatusOr<Summary> summary = SummaryOf(task.summaries->lights[i]);
    if (!summary.ok()) return summary.status();
    return MeetTolerance(*summary, task.lights[i], *task.tolerance, task.rules, task.options);
  }
  const absl::StatusOr<LightView> view = ViewOf(task, *surfaces, i);
  if (!view.ok()) return view.status();
  return MeetTolerance(*view, *task.tolerance, task.rules, task.options);
}

void MeetTolerances(const AllocationTask& task,
                    const Surfaces* surfaces,
                    const StepCallback& begin_step,
                    AllocationReport* report) {
  for (size_t i = 0; i < task.lights.size(); ++i) {
    begin_step(absl::StrCat("fitting ", task.lights[i].name));
    absl::StatusOr<ToleranceMap> map = SmallestMap(task, surfaces, i);
    AllocationEntry entry;
    if (!map.ok()) {
      AddLight(task, surfaces, task.lights[i], map.status(), entry, report);
      continue;
    }
    entry.reached = ReachedTolerance{map->is_met, map->reached_px, map->num_samples};
    AddLight(task, surfaces, task.lights[i], std::move(map->matrix), entry, report);
  }
}

}  // namespace

absl::StatusOr<AllocationReport> AllocateLights(const AllocationTask& task,
                                                const StepCallback& begin_step) {
  AllocationReport report;
  std::optional<Surfaces> surfaces;
  if (task.readback.has_value()) {
    if (absl::Status status = ValidateFitOptions(task.options); !status.ok()) return status;
    absl::StatusOr<Surfaces> found =
        FindSurfaces(*task.readback, LightMask(task.lights), task.options.samples);
    if (!found.ok()) return found.status();
    surfaces = *std::move(found);
    report.fit.camera = task.readback->camera;
    report.fit.depth_kind = task.readback->depth_kind;
  }
  report.fit.options = task.options;
  if (task.tolerance.has_value()) report.fit.options.metric = Metric::kL2;
  report.rules = task.rules;
  report.budget_texels = task.budget_texels;
  report.tolerance = task.tolerance;
  const Surfaces* known = surfaces.has_value() ? &*surfaces : nullptr;
  report.fit.plan_options = task.plans;
  if (task.plans.has_value() && known != nullptr) {
    DivideAmongPlans(task, *known, begin_step, &report);
  } else if (task.tolerance.has_value()) {
    MeetTolerances(task, known, begin_step, &report);
  } else if (absl::Status status = SplitBudget(task, known, begin_step, &report); !status.ok()) {
    return status;
  }
  return report;
}

v1::Allocation AllocationMessage(const AllocationReport& report, bool of_summaries) {
  v1::Allocation allocation = AllocationToProto(report);
  if (of_summaries) {
    ClearReadbackFigures(allocation.mutable_readback(), allocation.mutable_lights());
  }
  return allocation;
}

}  // namespace lightfit
