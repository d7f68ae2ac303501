#include "jobs/allocate_lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/map_size.h"
#include "jobs/fit_summary.h"
#include "optimizer/figures/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"

namespace lightfit {
namespace {

// Adds a light's map and how it came about, with the wrong pixels that its matrix will have, where
// it has one and there is a read-back.
void AddLight(const AllocationTask& task,
              const Light& light,
              absl::StatusOr<LightMatrix> matrix,
              const AllocationEntry& entry,
              AllocationReport* report) {
  LightFit& fit = report->fit.lights.emplace_back();
  report->entries.push_back(entry);
  fit.light = light;
  fit.matrix = std::move(matrix);
  if (!fit.matrix.ok() || !task.readback.has_value()) return;
  const absl::StatusOr<MatrixFigures> figures = EvaluateMatrix(
      *task.readback, light, fit.matrix->map_from_world, fit.matrix->map, task.options);
  if (figures.ok()) fit.wrong_share = figures->wrong_share;
}

MapSize EqualSquare(int64_t budget_texels, size_t num_maps) {
  const double share = static_cast<double>(budget_texels) / static_cast<double>(num_maps);
  const int side = static_cast<int>(std::min(std::sqrt(share), static_cast<double>(kMaxMapSide)));
  return {std::max(side, 1), std::max(side, 1)};
}

absl::StatusOr<Summary> SummaryForBudget(const AllocationTask& task, size_t i) {
  if (task.summaries.has_value()) return SummaryOf(task.summaries->lights[i]);
  if (!task.light_status[i].ok()) return task.light_status[i];
  return SummarizeForAnyAspect(*task.readback, task.lights[i], task.options);
}

std::vector<AllocationLight> SummarizeLights(const AllocationTask& task,
                                             const StepCallback& begin_step) {
  std::vector<AllocationLight> lights;
  for (size_t i = 0; i < task.lights.size(); ++i) {
    begin_step(absl::StrCat("summing up ", task.lights[i].name));
    lights.push_back({task.lights[i], SummaryForBudget(task, i), task.weights[i]});
  }
  return lights;
}

// From the read-back itself where there is one.
absl::StatusOr<LightMatrix> FitMap(const AllocationTask& task,
                                   const AllocationLight& light,
                                   MapSize map) {
  return task.readback.has_value() ? FitLight(*task.readback, light.light, map, task.options)
                                   : Fit(*light.summary, light.light, map, task.options);
}

absl::Status SplitBudget(const AllocationTask& task,
                         const StepCallback& begin_step,
                         AllocationReport* report) {
  const std::vector<AllocationLight> lights = SummarizeLights(task, begin_step);
  const absl::StatusOr<Allocation> allocation =
      AllocateBudget(lights, *task.budget_texels, task.rules, task.options);
  if (!allocation.ok()) return allocation.status();
  size_t num_maps = 0;
  for (const AllocatedMap& map : allocation->maps) num_maps += map.matrix.ok() ? 1 : 0;
  for (size_t i = 0; i < lights.size(); ++i) {
    begin_step(absl::StrCat("fitting ", lights[i].light.name));
    absl::StatusOr<LightMatrix> matrix = allocation->maps[i].matrix;
    AllocationEntry entry;
    entry.weight = lights[i].weight;
    if (matrix.ok()) {
      matrix = FitMap(task, lights[i], matrix->map);
      const MapSize equal = EqualSquare(*task.budget_texels, num_maps);
      const absl::StatusOr<LightMatrix> square = FitMap(task, lights[i], equal);
      if (square.ok()) entry.equal_split_energy = square->energy;
    }
    AddLight(task, lights[i].light, std::move(matrix), entry, report);
  }
  return absl::OkStatus();
}

absl::StatusOr<ToleranceMap> SmallestMap(const AllocationTask& task, size_t i) {
  const Light& light = task.lights[i];
  if (task.summaries.has_value()) {
    const absl::StatusOr<Summary> summary = SummaryOf(task.summaries->lights[i]);
    if (!summary.ok()) return summary.status();
    return MeetTolerance(*summary, light, *task.tolerance, task.rules, task.options);
  }
  if (!task.light_status[i].ok()) return task.light_status[i];
  return MeetTolerance(*task.readback, light, *task.tolerance, task.rules, task.options);
}

void MeetTolerances(const AllocationTask& task,
                    const StepCallback& begin_step,
                    AllocationReport* report) {
  for (size_t i = 0; i < task.lights.size(); ++i) {
    begin_step(absl::StrCat("fitting ", task.lights[i].name));
    absl::StatusOr<ToleranceMap> map = SmallestMap(task, i);
    AllocationEntry entry;
    if (!map.ok()) {
      AddLight(task, task.lights[i], map.status(), entry, report);
      continue;
    }
    entry.reached = ReachedTolerance{map->is_met, map->reached_px, map->num_samples};
    AddLight(task, task.lights[i], std::move(map->matrix), entry, report);
  }
}

}  // namespace

absl::StatusOr<AllocationReport> AllocateLights(const AllocationTask& task,
                                                const StepCallback& begin_step) {
  AllocationReport report;
  if (task.readback.has_value()) {
    report.fit.camera = task.readback->camera;
    report.fit.depth_kind = task.readback->depth_kind;
  }
  report.fit.options = task.options;
  if (task.tolerance.has_value()) report.fit.options.metric = Metric::kL2;
  report.rules = task.rules;
  report.budget_texels = task.budget_texels;
  report.tolerance = task.tolerance;
  if (task.tolerance.has_value()) {
    MeetTolerances(task, begin_step, &report);
  } else if (absl::Status status = SplitBudget(task, begin_step, &report); !status.ok()) {
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
