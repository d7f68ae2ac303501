#include "cli/allocate.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/allocate_inputs.h"
#include "cli/allocate_report.h"
#include "cli/exit_code.h"
#include "cli/number.h"
#include "cli/output_file.h"
#include "cli/summary_inputs.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit.h"

namespace lightfit {
namespace {

// One light's map and how it came about.
struct Outcome {
  LightFit fit;
  AllocationEntry entry;
};

// With the wrong pixels that its matrix will have, where it has one and there is a read-back.
LightFit Foretold(const AllocateInputs& inputs,
                  const Light& light,
                  absl::StatusOr<LightMatrix> matrix) {
  LightFit fit;
  fit.light = light;
  fit.matrix = std::move(matrix);
  if (!fit.matrix.ok() || !inputs.readback.has_value()) return fit;
  const absl::StatusOr<MatrixFigures> figures = EvaluateMatrix(
      inputs.readback->View(), light, fit.matrix->map_from_world, fit.matrix->map, inputs.options);
  if (figures.ok()) fit.wrong_share = figures->wrong_share;
  return fit;
}

MapSize EqualSquare(int64_t budget_texels, size_t num_maps) {
  constexpr double kMaxSide = 65536.0;
  const double share = static_cast<double>(budget_texels) / static_cast<double>(num_maps);
  const int side = static_cast<int>(std::min(std::sqrt(share), kMaxSide));
  return {std::max(side, 1), std::max(side, 1)};
}

// From the read-back itself where there is one.
absl::StatusOr<LightMatrix> FitMap(const AllocateInputs& inputs,
                                   const AllocationLight& light,
                                   MapSize map) {
  return inputs.readback.has_value()
             ? FitLight(inputs.readback->View(), light.light, map, inputs.options)
             : Fit(*light.summary, light.light, map, inputs.options);
}

absl::StatusOr<std::vector<Outcome>> SplitBudget(const AllocateFlags& flags,
                                                 const AllocateInputs& inputs) {
  Progress progress(2 * static_cast<int>(inputs.lights.size()), flags.fit.quiet);
  const std::vector<AllocationLight> lights = SummarizeLights(inputs, &progress);
  const absl::StatusOr<Allocation> allocation =
      AllocateBudget(lights, *flags.budget_texels, flags.rules, inputs.options);
  if (!allocation.ok()) return allocation.status();
  size_t num_maps = 0;
  for (const AllocatedMap& map : allocation->maps) num_maps += map.matrix.ok() ? 1 : 0;
  std::vector<Outcome> outcomes;
  for (size_t i = 0; i < lights.size(); ++i) {
    const Light& light = lights[i].light;
    progress.Begin(absl::StrCat("fitting ", light.name));
    absl::StatusOr<LightMatrix> matrix = allocation->maps[i].matrix;
    Outcome outcome;
    outcome.entry.weight = lights[i].weight;
    if (matrix.ok()) {
      matrix = FitMap(inputs, lights[i], matrix->map);
      const MapSize equal = EqualSquare(*flags.budget_texels, num_maps);
      const absl::StatusOr<LightMatrix> square = FitMap(inputs, lights[i], equal);
      if (square.ok()) outcome.entry.equal_split_energy = square->energy;
    }
    outcome.fit = Foretold(inputs, light, std::move(matrix));
    outcomes.push_back(std::move(outcome));
    progress.Advance();
  }
  return outcomes;
}

absl::StatusOr<ToleranceMap> SmallestMap(const AllocateInputs& inputs,
                                         size_t i,
                                         const Tolerance& tolerance,
                                         const MapSizeRules& rules) {
  const Light& light = inputs.lights[i];
  if (inputs.summaries.has_value()) {
    const absl::StatusOr<Summary> summary = SummaryOf(inputs.summaries->lights[i]);
    if (!summary.ok()) return summary.status();
    return MeetTolerance(*summary, light, tolerance, rules, inputs.options);
  }
  if (const absl::Status& status = inputs.readback->light_status[i]; !status.ok()) return status;
  return MeetTolerance(inputs.readback->View(), light, tolerance, rules, inputs.options);
}

std::vector<Outcome> MeetTolerances(const AllocateFlags& flags,
                                    const Tolerance& tolerance,
                                    const AllocateInputs& inputs) {
  std::vector<Outcome> outcomes;
  Progress progress(static_cast<int>(inputs.lights.size()), flags.fit.quiet);
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const Light& light = inputs.lights[i];
    progress.Begin(absl::StrCat("fitting ", light.name));
    absl::StatusOr<ToleranceMap> map = SmallestMap(inputs, i, tolerance, flags.rules);
    Outcome outcome;
    if (map.ok()) {
      outcome.entry.reached = ReachedTolerance{map->is_met, map->reached_px, map->num_samples};
      outcome.fit = Foretold(inputs, light, std::move(map->matrix));
    } else {
      outcome.fit = Foretold(inputs, light, map.status());
    }
    outcomes.push_back(std::move(outcome));
    progress.Advance();
  }
  return outcomes;
}

AllocationReport ReportOf(const AllocateFlags& flags,
                          const AllocateInputs& inputs,
                          const absl::optional<Tolerance>& tolerance,
                          std::vector<Outcome> outcomes) {
  AllocationReport report;
  if (inputs.readback.has_value()) {
    report.fit.source = flags.fit.readback_path;
    report.fit.camera = inputs.readback->camera;
    report.fit.depth_kind = inputs.readback->depth_kind;
  } else {
    report.fit.source = SourceText(flags.fit.summary_paths);
  }
  report.fit.options = inputs.options;
  if (tolerance.has_value()) report.fit.options.metric = Metric::kL2;
  report.fit.clip = flags.fit.clip;
  report.rules = flags.rules;
  report.budget_texels = flags.budget_texels;
  report.tolerance = tolerance;
  for (Outcome& outcome : outcomes) {
    report.fit.lights.push_back(std::move(outcome.fit));
    report.entries.push_back(outcome.entry);
  }
  return report;
}

std::string SourceLine(const AllocateFlags& flags, const AllocateInputs& inputs) {
  if (inputs.summaries.has_value()) {
    const int64_t num_frames = inputs.summaries->lights.front().num_frames();
    return absl::StrFormat("%s: %d %s",
                           TitleText(flags.fit.summary_paths),
                           num_frames,
                           num_frames == 1 ? "frame" : "frames");
  }
  return absl::StrFormat("%s: %d x %d pixels, final image %s times as wide",
                         flags.fit.readback_path,
                         inputs.readback->camera.width,
                         inputs.readback->camera.height,
                         FigureText(inputs.image_scale));
}

// Names on stderr the lights without a map, and those whose map misses the tolerance, with the way
// out; returns how many there are.
int PrintFailedLights(const AllocationReport& report) {
  int num_failed = 0;
  for (size_t i = 0; i < report.entries.size(); ++i) {
    const LightFit& fit = report.fit.lights[i];
    const std::string name = absl::StrCat("light \"", fit.light.name, "\"");
    const absl::optional<ReachedTolerance>& reached = report.entries[i].reached;
    if (!fit.matrix.ok()) {
      std::string message(fit.matrix.status().message());
      if (!absl::StrContains(message, name)) message = absl::StrCat(name, ": ", message);
      PrintError(absl::StrCat("no map for ", message));
      ++num_failed;
    } else if (reached.has_value() && !reached->is_met) {
      PrintError(
          absl::StrFormat("%s: %s pixels at the largest map, %d x %d; want %s: raise "
                          "--max-side (%d) or the tolerance",
                          name,
                          FigureText(reached->reached_px),
                          fit.matrix->map.width,
                          fit.matrix->map.height,
                          ToleranceText(*report.tolerance),
                          report.rules.max_side));
      ++num_failed;
    }
  }
  return num_failed;
}

// Names on stderr the lights with a map that some frames have nothing of.
void PrintMissingFrames(const AllocationReport& report, const SummarySet& summaries) {
  for (size_t i = 0; i < summaries.lights.size(); ++i) {
    const LightSummary& light = summaries.lights[i];
    if (report.fit.lights[i].matrix.ok() && light.num_frames_without > 0) {
      PrintWarning(MissingFramesText(light));
    }
  }
}

absl::Status WriteJson(const AllocateFlags& flags, const AllocationReport& report) {
  v1::Allocation allocation = AllocationToProto(report);
  if (!flags.fit.summary_paths.empty()) {
    ClearReadbackFigures(allocation.mutable_readback(), allocation.mutable_lights());
  }
  return WriteAllocationJson(flags.fit.json_path, allocation);
}

int Fail(ExitCode code, const absl::Status& status) {
  PrintError(status.message());
  return code;
}

}  // namespace

std::function<int()> DeclareAllocate(CLI::App* app) {
  const auto flags = std::make_shared<AllocateFlags>();
  DeclareAllocateFlags(app, flags.get());
  return [flags] { return RunAllocate(*flags); };
}

int RunAllocate(const AllocateFlags& flags) {
  absl::Status status = ValidateFitOptions(flags.fit.options);
  if (status.ok()) status = ValidateMapSizeRules(flags.rules);
  if (!status.ok()) return Fail(kExitUsage, status);
  if (!flags.fit.json_path.empty()) {
    status = CheckWritable("--json", flags.fit.json_path);
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  const absl::StatusOr<AllocateInputs> inputs = ReadAllocateInputs(flags);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());

  absl::optional<Tolerance> tolerance = flags.tolerance;
  if (tolerance.has_value()) tolerance->image_scale = inputs->image_scale;
  absl::StatusOr<std::vector<Outcome>> outcomes = tolerance.has_value()
                                                      ? MeetTolerances(flags, *tolerance, *inputs)
                                                      : SplitBudget(flags, *inputs);
  if (!outcomes.ok()) return Fail(kExitBadInput, outcomes.status());
  const AllocationReport report = ReportOf(flags, *inputs, tolerance, *std::move(outcomes));
  if (!flags.fit.quiet) {
    const std::string source = SourceLine(flags, *inputs);
    std::fputs(AllocationText(report, source, inputs->image_scale).c_str(), stdout);
    std::fflush(stdout);
  }
  const int num_failed = PrintFailedLights(report);
  if (inputs->summaries.has_value()) PrintMissingFrames(report, *inputs->summaries);
  if (!flags.fit.json_path.empty()) {
    status = WriteJson(flags, report);
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  return num_failed > 0 ? kExitIncomplete : kExitOk;
}

}  // namespace lightfit
