#include "cli/tune.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "cli/compare_inputs.h"
#include "cli/exit_code.h"
#include "cli/flags/standard_streams.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"
#include "cli/reports/tune_report.h"
#include "cli/unusable_lights.h"
#include "jobs/tune/journal.h"
#include "jobs/tune/json.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

absl::Status CheckOutputs(const TuneFlags& flags) {
  for (const auto& [flag, path] :
       {std::pair{"--json", flags.json_path}, std::pair{"--journal", flags.JournalPath()}}) {
    if (path.empty()) continue;
    absl::Status status = CheckWritable(flag, path);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

TuneOptions OptionsOf(const TuneFlags& flags) {
  TuneOptions options;
  options.map = flags.compare.map;
  options.fit = flags.compare.fit.options;
  options.bias = flags.bias;
  options.constant_share = flags.compare.judge.constant_share;
  options.evaluations = flags.evaluations;
  options.seed = flags.compare.scene.seed;
  return options;
}

absl::StatusOr<Journal> OpenJournal(const TuneFlags& flags,
                                    const CompareInputs& inputs,
                                    const TuneOptions& options) {
  const std::string path = flags.JournalPath();
  if (path.empty()) return Journal();
  return Journal::Open(path, TuneKey(inputs.stage, inputs.lights, options));
}

absl::StatusOr<std::vector<TunedLight>> TuneAll(const CompareInputs& inputs,
                                                TuneOptions options,
                                                bool quiet,
                                                Journal* journal) {
  Progress progress(static_cast<int>(inputs.lights.size()) * options.evaluations, quiet);
  std::vector<TunedLight> tuned;
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const Light& light = inputs.lights[i];
    progress.Begin(absl::StrCat(light.name, ": fit"));
    int num_evaluated = 0;
    options.after_evaluation = [&](double least) {
      ++num_evaluated;
      progress.Advance();
      progress.Begin(absl::StrCat(light.name, ": ", static_cast<int64_t>(least), " wrong pixels"));
    };
    absl::StatusOr<TunedLight> result =
        TuneLight(inputs.stage, light, options, static_cast<int>(i), journal);
    if (!result.ok()) return result.status();
    tuned.push_back(*std::move(result));
    // What was not begun, as of a light that cannot be used, is done as well.
    for (; num_evaluated < options.evaluations; ++num_evaluated) progress.Advance();
  }
  return tuned;
}

CompareHeading HeadingOf(const CompareInputs& inputs, const TuneOptions& options) {
  CompareHeading heading;
  heading.source = inputs.title;
  heading.screen_width = inputs.stage.screen.camera.width;
  heading.screen_height = inputs.stage.screen.camera.height;
  heading.readback_width = inputs.stage.readback.width();
  heading.readback_height = inputs.stage.readback.height();
  heading.maps = MapText(options.map);
  heading.fit = MethodText(options.fit);
  return heading;
}

// Names the lights without a matrix on stderr and returns how many there are.
int PrintFailedLights(const std::vector<TunedLight>& lights) {
  int num_failed = 0;
  for (const TunedLight& light : lights) {
    if (light.status.ok()) continue;
    ++num_failed;
    PrintFailedLight("matrix", light.light.name, light.status);
  }
  return num_failed;
}

}  // namespace

std::function<int()> DeclareTune(CLI::App* app) {
  const auto flags = std::make_shared<TuneFlags>();
  DeclareTuneFlags(app, flags.get());
  app->footer(app->get_footer() + LegendHelp(TuneLegend()));
  return [flags] { return RunTune(*flags); };
}

int RunTune(const TuneFlags& flags) {
  const TuneOptions options = OptionsOf(flags);
  absl::Status status = ValidateTuneOptions(options);
  if (!status.ok()) return Fail(kExitUsage, status);
  if (flags.compare.is_readback()) {
    return Fail(kExitBadInput,
                absl::InvalidArgumentError(absl::StrCat(
                    flags.compare.scene.scene,
                    ": a read-back has no true shadows to count wrong pixels by, want a scene; or "
                    "lightfit fit")));
  }
  status = CheckOutputs(flags);
  if (!status.ok()) return Fail(kExitBadInput, status);
  const absl::StatusOr<CompareInputs> inputs = ReadCompareInputs(flags.compare);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());
  for (const std::string& warning : inputs->warnings) PrintWarning(warning);
  absl::StatusOr<Journal> journal = OpenJournal(flags, *inputs, options);
  if (!journal.ok()) return Fail(kExitBadInput, journal.status());

  const absl::StatusOr<std::vector<TunedLight>> lights =
      TuneAll(*inputs, options, flags.quiet, &*journal);
  if (!lights.ok()) return Fail(kExitBadInput, lights.status());
  if (!flags.quiet) {
    const std::string text =
        TuneReportText(HeadingOf(*inputs, options), options, *lights, flags.compare.legend);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  int num_failed = PrintFailedLights(*lights);
  const absl::StatusOr<std::vector<ListedLight>> listed = ListLights(flags.compare.scene.lights);
  if (listed.ok()) num_failed += PrintUnusable(*listed, "matrix");
  if (!flags.json_path.empty()) {
    status = WriteFitResultJson(flags.json_path,
                                TunedToProto(WithStreamNames(flags.compare.scene.scene),
                                             inputs->stage,
                                             options,
                                             flags.clip,
                                             *lights));
    if (!status.ok()) return Fail(kExitBadInput, status);
  }
  return CodeFor(num_failed, static_cast<int>(lights->size()));
}

}  // namespace lightfit::cli
