#include "cli/allocate_inputs.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "cli/flags/choices.h"
#include "cli/flags/fit_inputs.h"
#include "cli/summary_inputs.h"

namespace lightfit::cli {
namespace {

absl::StatusOr<std::vector<double>> WeightsOf(const std::map<std::string, double>& weights,
                                              const std::vector<Light>& lights) {
  std::vector<std::string> names;
  names.reserve(lights.size());
  for (const Light& light : lights) names.push_back(light.name);
  std::vector<double> result(lights.size(), 1.0);
  for (const auto& [name, weight] : weights) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      return absl::InvalidArgumentError(absl::StrCat("--weight ",
                                                     name,
                                                     ": there is no such light, want one of ",
                                                     absl::StrJoin(names, ", "),
                                                     DidYouMean(name, names)));
    }
    result[static_cast<size_t>(found - names.begin())] = weight;
  }
  return result;
}

absl::Status ReadReadbackSource(const AllocateFlags& flags, AllocateInputs* inputs) {
  absl::StatusOr<FitInputs> fit = ReadFitInputs(flags.fit);
  if (!fit.ok()) return fit.status();
  inputs->task.lights = std::move(fit->lights);
  inputs->task.options = flags.fit.options;
  if (flags.image.has_value()) {
    const Camera& camera = fit->file.camera;
    inputs->image_scale = std::max(static_cast<double>(flags.image->width) / camera.width,
                                   static_cast<double>(flags.image->height) / camera.height);
  }
  inputs->notes = std::move(fit->notes);
  inputs->readback = std::move(fit->file);
  inputs->task.readback = inputs->readback->View();
  inputs->task.light_status = inputs->readback->light_status;
  return absl::OkStatus();
}

absl::Status ReadSummarySource(const AllocateFlags& flags, AllocationTask* task) {
  absl::StatusOr<SummarySet> summaries = ReadSummaries(flags.fit.summary_paths, flags.fit.only);
  if (!summaries.ok()) return summaries.status();
  const absl::StatusOr<FitOptions> options = OptionsFor(flags.fit, summaries->options);
  if (!options.ok()) return options.status();
  if (flags.tolerance.has_value() && options->metric != Metric::kL2) {
    return absl::InvalidArgumentError(
        absl::StrCat("--tolerance: the summaries hold sums for --metric ",
                     WordFor(MetricWords(), options->metric),
                     ", and a tolerance wants squares; summarise the frames again with --metric "
                     "l2, or give a read-back in place of --summary"));
  }
  for (const LightSummary& light : summaries->lights) task->lights.push_back(light.total.light);
  task->options = *options;
  task->summaries = *std::move(summaries);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<AllocateInputs> ReadAllocateInputs(const AllocateFlags& flags) {
  AllocateInputs inputs;
  AllocationTask& task = inputs.task;
  absl::Status status = flags.fit.summary_paths.empty() ? ReadReadbackSource(flags, &inputs)
                                                        : ReadSummarySource(flags, &task);
  if (!status.ok()) return status;
  absl::StatusOr<std::vector<double>> weights = WeightsOf(flags.weights, task.lights);
  if (!weights.ok()) return weights.status();
  task.weights = *std::move(weights);
  task.rules = flags.rules;
  task.budget_texels = flags.budget_texels;
  task.tolerance = flags.tolerance;
  task.plans = PlanOptionsOf(flags.fit.plan, flags.fit.options);
  if (task.tolerance.has_value()) task.tolerance->image_scale = inputs.image_scale;
  return inputs;
}

}  // namespace lightfit::cli
