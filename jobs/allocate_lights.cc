#include "jobs/allocate_lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/map_size.h"
#include "jobs/fit_summary.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/allocation.h"
#include "optimizer/sizing/map_shapes.h"

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
  if (task.tolerance.has_value()) {
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
