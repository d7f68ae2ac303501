#include "cli/fit.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "base/verbose.h"
#include "cli/exit_code.h"
#include "cli/fit_summary.h"
#include "cli/flags/fit_inputs.h"
#include "cli/flags/frame_inputs.h"
#include "cli/flags/standard_streams.h"
#include "cli/reports/fit_csv.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"
#include "cli/reports/plan_report.h"
#include "io/image_exr_write.h"
#include "io/notes/readback_notes.h"
#include "jobs/fit_comparison.h"
#include "jobs/fit_images.h"
#include "picture/fit_page.h"
#include "picture/png.h"
#include "picture/text.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

absl::Status CheckOutputs(const FitFlags& flags) {
  for (const auto& [flag, path] : {std::pair{"--json", flags.json_path},
                                   std::pair{"--csv", flags.csv_path},
                                   std::pair{"--picture", flags.picture_path},
                                   std::pair{"--footprint", flags.footprint_path}}) {
    if (path.empty()) continue;
    absl::Status status = CheckWritable(flag, path);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

void WarnAboutPixels(const std::vector<FitComparison>& comparisons) {
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) continue;
    const int64_t num_invalid = comparison.samples().invalid_depth;
    if (num_invalid > 0) {
      PrintWarning(absl::StrCat(num_invalid,
                                num_invalid == 1 ? " pixel" : " pixels",
                                " with an invalid depth (NaN, negative or out of range) ignored"));
    }
    return;  // The depth is the same for all lights.
  }
}

// What is no error, but less than was asked for.
void PrintNotes(const std::vector<FitComparison>& comparisons, const FitOptions& options) {
  for (const FitComparison& comparison : comparisons) {
    if (!comparison.ok()) continue;
    if (comparison.plan.has_value() && (*comparison.plan)->plan.maps.size() > 1) continue;
    const std::string text = FocusedInsteadText(
        comparison.plan.has_value() ? (*comparison.plan)->plan.maps[0] : comparison.final->matrix,
        options);
    if (!text.empty()) PrintWarning(text);
  }
}

// Names the lights without a matrix or plan on stderr and returns how many there are.
int PrintFailedLights(const std::vector<FitComparison>& comparisons, bool has_plans) {
  int num_failed = 0;
  for (const FitComparison& comparison : comparisons) {
    if (comparison.ok()) continue;
    ++num_failed;
    PrintFailedLight(has_plans ? "plan" : "matrix", comparison.light.name, comparison.status());
  }
  return num_failed;
}

// The stations of each light's search, where that is wanted.
void SaySearches(const std::vector<FitComparison>& comparisons) {
  for (const FitComparison& comparison : comparisons) {
    if (!IsVerbose() || !comparison.final.ok()) continue;
    for (const auto& step : comparison.final->matrix.search.trace) {
      Say(absl::StrFormat("%s, %s: %d maps looked at, energy %g",
                          comparison.light.name,
                          absl::StrReplaceAll(std::string(step.station), {{"_", " "}}),
                          step.evaluations,
                          step.energy));
    }
  }
}

LightFit LightFitOf(const FitComparison& comparison, double guard_texels) {
  LightFit fit;
  fit.light = comparison.light;
  if (!comparison.ok()) {
    fit.matrix = comparison.status();
  } else if (comparison.plan.has_value()) {
    const JudgedPlan& judged = **comparison.plan;
    SetPlan(judged.plan, judged.own_figures, guard_texels, &fit);
    if (comparison.final.ok()) fit.one_map = comparison.final->own_figures;
  } else {
    fit.matrix = comparison.final->matrix;
    fit.wrong_share = comparison.final->own_figures.wrong_share;
  }
  if (comparison.focused.ok()) fit.focused = comparison.focused->own_figures;
  if (comparison.published.ok()) fit.as_published = comparison.published->own_figures;
  return fit;
}

FitReport JsonReport(const FitFlags& flags,
                     const FitOptions& options,
                     const ReadbackFile& file,
                     const std::vector<FitComparison>& comparisons) {
  FitReport report;
  report.source = WithStreamNames(flags.readback_path);
  report.camera = file.camera;
  report.depth_kind = file.depth_kind;
  report.options = options;
  report.plan_options = PlanOptionsOf(flags.plan, flags.options);
  report.map = flags.map;
  report.clip = flags.clip;
  for (const FitComparison& comparison : comparisons) {
    report.lights.push_back(LightFitOf(comparison, flags.plan.guard_texels));
  }
  return report;
}

// The folder tells frames of one name apart: "yard_180/0001.exr".
std::string TitleOf(const std::string& path) {
  const std::filesystem::path file(WithStreamNames(path));
  return (file.parent_path().filename() / file.filename()).string();
}

// The file, and what of it was taken.
std::string SourceText(const FitFlags& flags, const ReadbackFile& file) {
  return absl::StrCat(WithStreamNames(flags.readback_path), " (", OriginText(file.origin), ")");
}

// What is computed before anything is printed, so that the progress bar has the terminal to itself.
struct Outcome {
  std::vector<FitComparison> comparisons;
  absl::StatusOr<Canvas> picture = absl::UnknownError("not drawn");
};

Outcome FitAndDraw(const FitFlags& flags, const FitOptions& options, const FitInputs& inputs) {
  const bool draws = !flags.picture_path.empty();
  Typeface typeface;
  if (draws) {
    typeface = Typeface::Find();
    if (!typeface.found()) {
      PrintWarning(
          "no typeface found, so the picture has no text; install fonts-dejavu-core or set "
          "LIGHTFIT_FONT to a .ttf file");
    }
  }
  Progress progress(static_cast<int>(inputs.lights.size()) + (draws ? 1 : 0), flags.quiet);
  bool is_first = true;
  const auto before_light = [&](const Light& light) {
    if (!is_first) progress.Advance();
    is_first = false;
    progress.Begin(absl::StrCat("fitting ", light.name));
  };
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.plan, flags.options);
  const std::vector<absl::Status>& light_status = inputs.file.light_status;
  ComparedReadback compared =
      plan.has_value()
          ? CompareLights(inputs.View(), inputs.lights, light_status, *plan, before_light)
          : CompareLights(
                inputs.View(), inputs.lights, light_status, flags.map, options, before_light);
  progress.Advance();
  Outcome outcome = {std::move(compared.comparisons)};
  if (draws) {
    progress.Begin("drawing");
    const PictureOptions picture = {
        TitleOf(flags.readback_path),
        plan.has_value()
            ? PlanSizeText(*plan)
            : absl::StrFormat("shadow map %d x %d texels", flags.map.width, flags.map.height),
        options.samples,
        ShortMethodText(options),
        flags.plan.guard_texels,
        plan.has_value()};
    outcome.picture = compared.surfaces.ok()
                          ? DrawPicture(*compared.surfaces, outcome.comparisons, picture, typeface)
                          : compared.surfaces.status();
  }
  return outcome;
}

// Of lights beyond those that the picture shows.
void AddOutcome(Outcome added, Outcome* outcome) {
  if (outcome->comparisons.empty()) {
    *outcome = std::move(added);
    return;
  }
  for (FitComparison& comparison : added.comparisons) {
    outcome->comparisons.push_back(std::move(comparison));
  }
}

absl::Status WriteOutputs(const FitFlags& flags,
                          const FitOptions& options,
                          const FitInputs& inputs,
                          const Outcome& outcome) {
  const ReadbackFile& file = inputs.file;
  if (!flags.json_path.empty()) {
    const FitReport report = JsonReport(flags, options, file, outcome.comparisons);
    v1::FitResult result = FitResultToProto(report);
    PutNotes(file, result.mutable_readback());
    absl::Status status = WriteFitResultJson(flags.json_path, result);
    if (!status.ok()) return status;
  }
  if (!flags.csv_path.empty()) {
    const std::string csv = FitCsv(inputs.View(), flags.map, options, outcome.comparisons);
    absl::Status status = WriteTextFileAtomically(flags.csv_path, csv);
    if (!status.ok()) return status;
  }
  if (!flags.footprint_path.empty()) {
    const Readback readback = inputs.View();
    const absl::StatusOr<std::vector<ExrImage>> images =
        FitImages(readback, outcome.comparisons, options);
    if (!images.ok()) return images.status();
    absl::Status status = WriteImageExr(flags.footprint_path, readback.camera, *images);
    if (!status.ok()) return status;
  }
  if (flags.picture_path.empty()) return absl::OkStatus();
  if (!outcome.picture.ok()) return outcome.picture.status();
  return WritePng(*outcome.picture, flags.picture_path);
}

}  // namespace

std::function<int()> DeclareFit(CLI::App* app) {
  const auto flags = std::make_shared<FitFlags>();
  DeclareFitFlags(app, flags.get());
  app->footer(app->get_footer() + LegendHelp(FitLegend() + "With --maps:\n" + PlanLegend()));
  return [flags] { return flags->summary_paths.empty() ? RunFit(*flags) : RunFitSummary(*flags); };
}

int RunFit(const FitFlags& flags) {
  const FitOptions options =
      flags.as_published ? FitOptions::AsPublished(flags.options) : flags.options;
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.plan, flags.options);
  absl::Status status = plan.has_value() ? ValidatePlanOptions(*plan) : ValidateFitOptions(options);
  if (!status.ok()) return Fail(kExitUsage, status);
  status = CheckOutputs(flags);
  if (!status.ok()) return Fail(kExitBadInput, status);
  const absl::StatusOr<std::vector<ListedLight>> lights = ListFrameLights(flags);
  if (!lights.ok()) return Fail(kExitBadInput, lights.status());
  absl::StatusOr<FitInputs> inputs;  // of the first lights
  Outcome outcome;
  for (std::vector<ListedLight>& group : GroupsOfLights(*lights)) {
    absl::StatusOr<FitInputs> of_group = ReadFitInputs(flags, std::move(group));
    if (!of_group.ok()) return Fail(kExitBadInput, of_group.status());
    AddOutcome(FitAndDraw(flags, options, *of_group), &outcome);
    if (!inputs.ok()) inputs = std::move(of_group);
  }
  if (!flags.picture_path.empty() && outcome.comparisons.size() > inputs->lights.size()) {
    PrintWarning(absl::StrCat(
        "--picture shows the first ", inputs->lights.size(), " lights; choose others with --only"));
  }
  if (!flags.quiet) {
    const Readback readback = inputs->View();
    const std::string source = SourceText(flags, inputs->file);
    const std::string text =
        plan.has_value()
            ? PlanReportText(source, readback, *plan, outcome.comparisons, flags.legend)
            : FitReportText(
                  source, readback, flags.map, options, outcome.comparisons, flags.legend);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  PrintWarnings(inputs->notes.Warnings());
  SaySearches(outcome.comparisons);
  WarnAboutPixels(outcome.comparisons);
  PrintNotes(outcome.comparisons, options);
  const int num_failed = PrintFailedLights(outcome.comparisons, plan.has_value());
  status = WriteOutputs(flags, options, *inputs, outcome);
  if (!status.ok()) return Fail(kExitBadInput, status);
  return CodeFor(num_failed, static_cast<int>(outcome.comparisons.size()));
}

}  // namespace lightfit::cli
