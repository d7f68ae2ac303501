#include "cli/allocate_inputs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "cli/choices.h"
#include "cli/fit_inputs.h"
#include "cli/suggest.h"
#include "cli/summary_inputs.h"
#include "optimizer/map_shapes.h"

namespace lightfit {
namespace {

absl::StatusOr<std::vector<double>> WeightsOf(const std::map<std::string, double>& weights,
                                              const std::vector<Light>& lights) {
  std::vector<std::string> names;
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
  inputs->lights = std::move(fit->lights);
  inputs->options = flags.fit.options;
  if (flags.image.has_value()) {
    const Camera& camera = fit->file.camera;
    inputs->image_scale = std::max(static_cast<double>(flags.image->width) / camera.width,
                                   static_cast<double>(flags.image->height) / camera.height);
  }
  inputs->readback = std::move(fit->file);
  return absl::OkStatus();
}

absl::Status ReadSummarySource(const AllocateFlags& flags, AllocateInputs* inputs) {
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
  for (const LightSummary& light : summaries->lights) inputs->lights.push_back(light.total.light);
  inputs->options = *options;
  inputs->summaries = *std::move(summaries);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<AllocateInputs> ReadAllocateInputs(const AllocateFlags& flags) {
  AllocateInputs inputs;
  absl::Status status = flags.fit.summary_paths.empty() ? ReadReadbackSource(flags, &inputs)
                                                        : ReadSummarySource(flags, &inputs);
  if (!status.ok()) return status;
  absl::StatusOr<std::vector<double>> weights = WeightsOf(flags.weights, inputs.lights);
  if (!weights.ok()) return weights.status();
  inputs.weights = *std::move(weights);
  return inputs;
}

std::vector<AllocationLight> SummarizeLights(const AllocateInputs& inputs, Progress* progress) {
  std::vector<AllocationLight> lights;
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const Light& light = inputs.lights[i];
    progress->Begin(absl::StrCat("summing up ", light.name));
    AllocationLight entry;
    entry.light = light;
    entry.weight = inputs.weights[i];
    if (inputs.summaries.has_value()) {
      entry.summary = SummaryOf(inputs.summaries->lights[i]);
    } else if (const absl::Status& status = inputs.readback->light_status[i]; status.ok()) {
      entry.summary = SummarizeForAnyAspect(inputs.readback->View(), light, inputs.options);
    } else {
      entry.summary = status;
    }
    lights.push_back(std::move(entry));
    progress->Advance();
  }
  return lights;
}

}  // namespace lightfit
