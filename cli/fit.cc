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
#include "base/output_file.h"
#include "base/progress.h"
#include "cli/exit_code.h"
#include "cli/fit_summary.h"
#include "cli/flags/fit_inputs.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/plan_report.h"
#include "io/notes/readback_notes.h"
#include "jobs/fit_comparison.h"
#include "picture/fit_page.h"
#include "picture/png.h"
#include "picture/text.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

absl::Status CheckOutputs(const FitFlags& flags) {
  for (const auto& [flag, path] :
       {std::pair{"--json", flags.json_path}, std::pair{"--picture", flags.picture_path}}) {
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
  report.source = flags.readback_path;
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
  const std::filesystem::path file(path);
  return (file.parent_path().filename() / file.filename()).string();
}

// The file, and what of it was taken.
std::string SourceText(const FitFlags& flags, const ReadbackFile& file) {
  return absl::StrCat(flags.readback_path, " (", OriginText(file.origin), ")");
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

absl::Status WriteOutputs(const FitFlags& flags,
                          const FitOptions& options,
                          const ReadbackFile& file,
                          const Outcome& outcome) {
  if (!flags.json_path.empty()) {
    const FitReport report = JsonReport(flags, options, file, outcome.comparisons);
    v1::FitResult result = FitResultToProto(report);
    PutNotes(file, result.mutable_readback());
    absl::Status status = WriteFitResultJson(flags.json_path, result);
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
  const absl::StatusOr<FitInputs> inputs = ReadFitInputs(flags);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());

  const Outcome outcome = FitAndDraw(flags, options, *inputs);
  if (!flags.quiet) {
    const Readback readback = inputs->View();
    const std::string source = SourceText(flags, inputs->file);
    const std::string text =
        plan.has_value() ? PlanReportText(source, readback, *plan, outcome.comparisons)
                         : FitReportText(source, readback, flags.map, options, outcome.comparisons);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  PrintWarnings(inputs->notes.Warnings());
  WarnAboutPixels(outcome.comparisons);
  PrintNotes(outcome.comparisons, options);
  const int num_failed = PrintFailedLights(outcome.comparisons, plan.has_value());
  status = WriteOutputs(flags, options, inputs->file, outcome);
  if (!status.ok()) return Fail(kExitBadInput, status);
  return num_failed > 0 ? kExitIncomplete : kExitOk;
}

}  // namespace lightfit::cli
