#include "cli/compare.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "cli/compare_inputs.h"
#include "cli/exit_code.h"
#include "cli/flags/standard_streams.h"
#include "cli/reports/compare_csv.h"
#include "cli/reports/compare_report.h"
#include "cli/reports/fit_report.h"
#include "cli/reports/legend.h"
#include "cli/reports/plan_report.h"
#include "cli/unusable_lights.h"
#include "io/image_exr_write.h"
#include "jobs/compare/json.h"
#include "jobs/compare/masks.h"
#include "picture/compare_page.h"
#include "picture/png.h"

namespace lightfit::cli {
namespace {

absl::Status CheckOutputs(const CompareFlags& flags) {
  for (const auto& [flag, path] : {std::pair{"--csv", flags.csv_path},
                                   std::pair{"--json", flags.json_path},
                                   std::pair{"--picture", flags.picture_path}}) {
    if (path.empty()) continue;
    absl::Status status = CheckWritable(flag, path);
    if (!status.ok()) return status;
  }
  if (flags.masks_path.empty()) return absl::OkStatus();
  if (flags.is_readback()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--masks ",
                     flags.masks_path,
                     ": a read-back has no true shadows to find wrong pixels by, want a scene; or "
                     "lightfit fit --footprint FILE.exr, which foretells them"));
  }
  return MakeOutputFolder("--masks", flags.masks_path);
}

Typeface FindTypeface() {
  Typeface typeface = Typeface::Find();
  if (!typeface.found()) {
    PrintWarning(
        "no typeface found, so the picture has no text; install fonts-dejavu-core or set "
        "LIGHTFIT_FONT to a .ttf file");
  }
  return typeface;
}

// Whether the light was there in the next frame too.
bool HasNext(const CompareInputs& inputs, size_t light) {
  return inputs.next_readback == nullptr || inputs.next_readback->file.light_status[light].ok();
}

// Nothing of a light that cannot be used: it has no truth.
absl::Status WriteMasks(const std::string& path,
                        const CompareStage& stage,
                        const LightComparison& light) {
  if (light.truth.empty()) return absl::OkStatus();
  const absl::StatusOr<std::vector<ExrImage>> masks = MaskImages(light);
  return masks.ok() ? WriteImageExr(path, stage.screen.camera, *masks) : masks.status();
}

// Images are kept for as long as their masks are being written.
absl::StatusOr<std::vector<LightComparison>> CompareAll(const CompareFlags& flags,
                                                        const CompareInputs& inputs) {
  const size_t steps_per_row = inputs.next != nullptr ? 2 : 1;
  const size_t num_steps = RowNames(inputs.options).size() * steps_per_row;
  Progress progress(static_cast<int>(inputs.lights.size() * num_steps), flags.quiet);
  CompareOptions options = inputs.options;
  options.keep_images = !flags.masks_path.empty();
  const std::vector<std::string> mask_names = MaskFileNames(inputs.lights);
  std::vector<LightComparison> comparisons;
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const Light& light = inputs.lights[i];
    options.next = HasNext(inputs, i) ? inputs.next.get() : nullptr;
    size_t num_begun = 0;
    options.before_row = [&](const std::string& row) {
      if (num_begun++ > 0) progress.Advance();
      progress.Begin(absl::StrCat(light.name, ": ", row));
    };
    comparisons.push_back(inputs.light_status[i].ok()
                              ? CompareMaps(inputs.stage, light, options)
                              : FailedRows(light, inputs.light_status[i], options));
    // What was not begun, as of a light that cannot be used, is done as well.
    for (size_t step = num_begun == 0 ? 0 : num_begun - 1; step < num_steps; ++step) {
      progress.Advance();
    }
    if (!options.keep_images) continue;
    LightComparison& done = comparisons.back();
    absl::Status status = WriteMasks(flags.masks_path + "/" + mask_names[i], inputs.stage, done);
    if (!status.ok()) return status;
    for (ComparedRow& row : done.rows) row.image = {};
    done.truth.clear();
  }
  return comparisons;
}

// Names the lights without a matrix or plan of ours on stderr and returns how many there are.
int PrintFailedLights(const std::vector<LightComparison>& comparisons, bool has_plans) {
  int num_failed = 0;
  for (const LightComparison& comparison : comparisons) {
    const absl::Status& status = comparison.lightfit().status;
    if (status.ok()) continue;
    ++num_failed;
    PrintFailedLight(has_plans ? "plan" : "matrix", comparison.light.name, status);
  }
  return num_failed;
}

std::string SizeText(const CompareOptions& options) {
  return options.plan.has_value() ? PlanSizeText(*options.plan) : MapText(options.map);
}

CompareHeading HeadingOf(const CompareInputs& inputs) {
  CompareHeading heading;
  heading.source = inputs.title;
  heading.screen_width = inputs.stage.has_truth() ? inputs.stage.screen.camera.width : 0;
  heading.screen_height = inputs.stage.has_truth() ? inputs.stage.screen.camera.height : 0;
  heading.readback_width = inputs.stage.readback.width();
  heading.readback_height = inputs.stage.readback.height();
  heading.maps = SizeText(inputs.options);
  heading.phases = inputs.options.judge.phases;
  const std::optional<PlanOptions>& plan = inputs.options.plan;
  heading.fit = plan.has_value() ? PlanMethodText(*plan) : MethodText(inputs.options.fit);
  heading.has_plans = HasPlans(inputs.options);
  heading.next = inputs.next_title;
  return heading;
}

size_t LightToDraw(const CompareFlags& flags, const std::vector<LightComparison>& comparisons) {
  for (size_t i = 0; i < comparisons.size(); ++i) {
    if (comparisons[i].light.name == flags.picture_light) return i;
  }
  return MostTellingLight(comparisons, flags.picture_bias);
}

// Images of one light only are kept: it is computed once more, the same.
absl::Status WritePicture(const CompareFlags& flags,
                          const CompareInputs& inputs,
                          const std::vector<LightComparison>& comparisons) {
  const Typeface typeface = FindTypeface();
  const size_t light = LightToDraw(flags, comparisons);
  CompareOptions options = inputs.options;
  options.keep_images = true;
  options.next = nullptr;
  const LightComparison comparison = CompareMaps(inputs.stage, inputs.lights[light], options);
  const ComparePictureOptions picture = {
      inputs.title, SizeText(options), HasPlans(options), options.judge.phases, flags.picture_bias};
  return WritePng(DrawComparePicture(inputs.stage, comparison, picture, typeface),
                  flags.picture_path);
}

absl::Status WriteOutputs(const CompareFlags& flags,
                          const CompareInputs& inputs,
                          const std::vector<LightComparison>& comparisons) {
  absl::Status status;
  if (!flags.csv_path.empty()) {
    status.Update(WriteTextFileAtomically(flags.csv_path, CompareCsv(comparisons)));
  }
  if (!flags.json_path.empty()) {
    status.Update(WriteComparisonJson(
        flags.json_path,
        ComparisonToProto(
            WithStreamNames(flags.scene.scene), inputs.stage, inputs.options, comparisons)));
  }
  if (!flags.picture_path.empty()) status.Update(WritePicture(flags, inputs, comparisons));
  return status;
}

}  // namespace

std::function<int()> DeclareCompare(CLI::App* app) {
  const auto flags = std::make_shared<CompareFlags>();
  DeclareCompareFlags(app, flags.get());
  app->footer(app->get_footer() + LegendHelp(CompareLegend()));
  return [flags] { return RunCompare(*flags); };
}

int RunCompare(const CompareFlags& flags) {
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.fit.plan, flags.fit.options);
  absl::Status status =
      plan.has_value() ? ValidatePlanOptions(*plan) : ValidateFitOptions(flags.fit.options);
  if (!status.ok()) return Fail(kExitUsage, status);
  status = CheckOutputs(flags);
  if (!status.ok()) return Fail(kExitBadInput, status);
  const absl::StatusOr<CompareInputs> inputs = ReadCompareInputs(flags);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());
  for (const std::string& warning : inputs->warnings) PrintWarning(warning);

  const absl::StatusOr<std::vector<LightComparison>> compared = CompareAll(flags, *inputs);
  if (!compared.ok()) return Fail(kExitBadInput, compared.status());
  const std::vector<LightComparison>& comparisons = *compared;
  if (!flags.quiet) {
    const std::string text =
        CompareReportText(HeadingOf(*inputs), comparisons, flags.per_light, flags.legend);
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
  }
  int num_failed = PrintFailedLights(comparisons, plan.has_value());
  if (!flags.is_readback()) {
    const absl::StatusOr<std::vector<ListedLight>> lights = ListLights(flags.scene.lights);
    if (lights.ok()) num_failed += PrintUnusable(*lights, "shadow");
  }
  status = WriteOutputs(flags, *inputs, comparisons);
  if (!status.ok()) return Fail(kExitBadInput, status);
  return CodeFor(num_failed, static_cast<int>(comparisons.size()));
}

}  // namespace lightfit::cli
