#include "cli/summarize.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "base/number.h"
#include "base/output_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text_file.h"
#include "base/version.h"
#include "cli/exit_code.h"
#include "cli/flags/fit_inputs.h"
#include "cli/summary_inputs.h"
#include "cli/unusable_lights.h"
#include "jobs/fit_summary.h"
#include "optimizer/fit.h"
#include "wire/plan_proto.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit summarize 0007.exr --lights scene.json -o 0007.summary\n"
    "  lightfit summarize *.summary -o shot.summary\n"
    "  lightfit fit --summary shot.summary --map 2048x2048 --json shot.json\n"
    "\n"
    "A summary has what fit needs to know of any number of frames, about two kilobytes per light.\n"
    "The same frames give the same file to the last byte in whatever order and groups they are\n"
    "added; a frame that is given twice counts twice. Lights, metric and cover must be the same.\n"
    "With several read-backs --frame is that of the first, and the others count on from it.\n"
    "The l1 metrics weigh samples by a map: each frame's own best one, or for a closer fit of a\n"
    "whole shot the maps of a first round, --weigh-by shot.json.";

// Matrices of a result, by the name of the light; a light without one has its status.
using MatricesByLight = std::map<std::string, absl::StatusOr<Eigen::Matrix4d>>;

absl::StatusOr<MatricesByLight> ReadMatrices(const std::string& path) {
  const absl::StatusOr<v1::FitResult> result = ReadFitResultJson(path);
  if (!result.ok()) return result.status();
  MatricesByLight matrices;
  for (const v1::LightResult& light : result->lights()) {
    if (absl::Status status = CheckHasOneMap(light); !status.ok()) return InFile(path, status);
    matrices[light.name()] = light.has_map_from_world()
                                 ? MatrixFromProto(light.map_from_world(), "map_from_world")
                                 : absl::FailedPreconditionError(light.status().message());
  }
  if (matrices.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": has no lights, want a result of lightfit fit --json"));
  }
  return matrices;
}

struct Job {
  const SummarizeFlags& flags;
  std::vector<Light> lights;  // of the read-backs
  std::optional<MatricesByLight> weigh_by;
};

absl::StatusOr<Job> JobOf(const SummarizeFlags& flags, const std::vector<bool>& is_summary) {
  Job job = {flags, {}, {}};
  const bool has_readbacks =
      std::find(is_summary.begin(), is_summary.end(), false) != is_summary.end();
  if (has_readbacks) {
    absl::StatusOr<std::vector<Light>> lights = ReadFitLights(flags.fit);
    if (!lights.ok()) return lights.status();
    job.lights = *std::move(lights);
  }
  if (flags.weigh_by_path.empty()) return job;
  if (!has_readbacks) {
    return absl::InvalidArgumentError(
        "--weigh-by: the samples of summary files are weighed already, leave it out");
  }
  if (!IsL1(flags.fit.options.metric)) {
    return absl::InvalidArgumentError(
        "--weigh-by: is for --metric l1 and l1-edge, squares are not weighed by a map; leave it "
        "out");
  }
  absl::StatusOr<MatricesByLight> matrices = ReadMatrices(flags.weigh_by_path);
  if (!matrices.ok()) return matrices.status();
  job.weigh_by = *std::move(matrices);
  return job;
}

absl::StatusOr<Eigen::Matrix4d> WeighingMap(const MatricesByLight& matrices, const Light& light) {
  const auto found = matrices.find(light.name);
  if (found == matrices.end()) {
    return absl::NotFoundError(
        "the result of --weigh-by does not have this light; leave it out with --only");
  }
  if (found->second.ok()) return *found->second;
  return absl::Status(found->second.status().code(),
                      absl::StrCat("the result of --weigh-by has no matrix of this light (",
                                   found->second.status().message(),
                                   "); leave it out with --only"));
}

LightSummary SummarizeLight(const Job& job,
                            const ReadbackFile& file,
                            size_t light_index,
                            const std::string& frame) {
  const Light& light = job.lights[light_index];
  const FitOptions& options = job.flags.fit.options;
  std::optional<Eigen::Matrix4d> weighed_in;
  const auto summarize = [&]() -> absl::StatusOr<Summary> {
    if (job.weigh_by.has_value()) {
      const absl::StatusOr<Eigen::Matrix4d> map = WeighingMap(*job.weigh_by, light);
      if (!map.ok()) return map.status();
      weighed_in = *map;
    }
    const absl::Status& light_status = file.light_status[light_index];
    if (!light_status.ok()) return light_status;
    return weighed_in.has_value() ? SummarizeInMap(file.View(), light, *weighed_in, options)
                                  : Summarize(file.View(), light, options);
  };
  LightSummary summary = SummaryOfFrame(light, summarize(), frame, options);
  summary.weighed_in = weighed_in;
  return summary;
}

// `frame` counts the read-backs from 0.
absl::StatusOr<SummarySet> SummarizeReadback(const Job& job, const std::string& path, int frame) {
  FitFlags flags = job.flags.fit;
  flags.frame += frame;
  const absl::StatusOr<ReadbackExrOptions> options = ReadbackOptionsOf(flags);
  if (!options.ok()) return options.status();
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(path, job.lights, *options);
  if (!file.ok()) return file.status();
  if (absl::Status status = ValidateReadback(file->View()); !status.ok()) {
    return InFile(path, status);
  }
  // Folders differ between the machines of a farm, and would make files differ.
  const std::string name = std::filesystem::path(path).filename().string();
  for (absl::Status& status : file->light_status) {
    status = absl::Status(status.code(), absl::StrReplaceAll(status.message(), {{path, name}}));
  }
  std::vector<LightSummary> lights;
  for (size_t i = 0; i < job.lights.size(); ++i) {
    lights.push_back(SummarizeLight(job, *file, i, name));
  }
  return MakeSummarySet(flags.options, std::move(lights));
}

// Results in the order of the inputs.
std::vector<absl::StatusOr<SummarySet>> SummarizeInputs(const Job& job,
                                                        const std::vector<bool>& is_summary) {
  const std::vector<std::string>& inputs = job.flags.inputs;
  std::vector<int> frames(inputs.size(), 0);  // read-backs before this input
  for (size_t i = 1; i < inputs.size(); ++i) {
    frames[i] = frames[i - 1] + (is_summary[i - 1] ? 0 : 1);
  }
  std::vector<absl::StatusOr<SummarySet>> sets(inputs.size());
  const auto count = static_cast<int>(inputs.size());
  Progress progress(count, job.flags.fit.quiet);
  std::mutex progress_mutex;
  ParallelFor(count, /*chunk=*/1, NumProcessors(), [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      sets[i] = is_summary[i] ? ReadSummary(inputs[i], job.flags.fit.only)
                              : SummarizeReadback(job, inputs[i], frames[i]);
      const std::lock_guard<std::mutex> lock(progress_mutex);
      progress.Begin(absl::StrCat("summarising ", inputs[i]));
      progress.Advance();
    }
  });
  return sets;
}

// The sum of what could be read; what could not is named on stderr and counted.
absl::StatusOr<SummarySet> SumOf(const std::vector<absl::StatusOr<SummarySet>>& sets,
                                 const std::vector<std::string>& inputs,
                                 int* num_failed) {
  std::optional<SummarySet> sum;
  for (size_t i = 0; i < sets.size(); ++i) {
    if (!sets[i].ok()) {
      PrintError(absl::StrCat("left out: ", sets[i].status().message()));
      ++*num_failed;
    } else if (!sum.has_value()) {
      sum = *sets[i];
    } else if (absl::Status status = AddToSet(*sets[i], &*sum); !status.ok()) {
      return InFile(inputs[i], status);
    }
  }
  if (!sum.has_value()) {
    return absl::InvalidArgumentError("no input could be used, so nothing is written");
  }
  return *std::move(sum);
}

std::string CountText(int64_t count, const char* noun) {
  return absl::StrCat(count, " ", noun, count == 1 ? "" : "s");
}

// "sun: 1012 samples of 24 frames, 1.21 kB" for each light.
std::string ReportText(const SummarySet& sum) {
  std::string text;
  for (const LightSummary& light : sum.lights) {
    absl::StrAppend(&text,
                    light.name(),
                    ": ",
                    CountText(light.total.counts.used, "sample"),
                    " of ",
                    CountText(light.total.num_frames, "frame"),
                    ", ",
                    FigureText(1e-3 * static_cast<double>(SummaryBytes(light))),
                    " kB\n");
  }
  return text;
}

// Lights that a read-back of this run has nothing of are errors; those that a summary file told of
// have been reported when that was made.
bool PrintMissingFrames(const SummarySet& sum,
                        const std::vector<absl::StatusOr<SummarySet>>& sets,
                        const std::vector<bool>& is_summary) {
  bool is_complete = true;
  for (size_t l = 0; l < sum.lights.size(); ++l) {
    if (sum.lights[l].num_frames_without == 0) continue;
    bool is_new = false;
    for (size_t i = 0; i < sets.size(); ++i) {
      is_new =
          is_new || (!is_summary[i] && sets[i].ok() && sets[i]->lights[l].num_frames_without > 0);
    }
    const std::string text = MissingFramesText(sum.lights[l]);
    is_new ? PrintError(text) : PrintWarning(text);
    is_complete = is_complete && !is_new;
  }
  return is_complete;
}

}  // namespace

std::function<int()> DeclareSummarize(CLI::App* app) {
  const auto flags = std::make_shared<SummarizeFlags>();
  const std::string group = "Input";
  app->add_option("inputs", flags->inputs, "OpenEXR files, and summary files to add")
      ->required()
      ->type_name("READBACK.exr|FILE.summary");
  DeclareLightFlags(app, &flags->fit.lights, group);
  DeclareOnlyFlag(app, group, &flags->fit);
  DeclareReadbackFlags(app, group, &flags->fit);
  DeclareCameraFlags(app, "Camera", &flags->fit);
  DeclareSummingFlags(app, &flags->fit.options);
  app->add_option("--weigh-by",
                  flags->weigh_by_path,
                  "l1 metrics: weigh samples by the maps in this result of lightfit fit [by each "
                  "frame's own best map]")
      ->type_name("RESULT.json")
      ->group("Method");
  app->add_option("-o,--output", flags->output_path, "Write the summary to this file")
      ->required()
      ->type_name("FILE.summary")
      ->group("Output");
  app->add_flag("--quiet", flags->fit.quiet, "No figures and no progress; errors and warnings only")
      ->group("Output");
  app->footer(kExamples);
  app->callback([app, flags] {
    flags->fit.has_metric = app->count("--metric") > 0;
    flags->fit.has_cover = app->count("--cover") > 0;
  });
  return [flags] { return RunSummarize(*flags); };
}

int RunSummarize(const SummarizeFlags& flags) {
  if (absl::Status status = CheckWritable("-o", flags.output_path); !status.ok()) {
    return Fail(kExitBadInput, status);
  }
  std::vector<bool> is_summary;
  for (const std::string& input : flags.inputs) is_summary.push_back(IsSummaryFile(input));
  const absl::StatusOr<Job> job = JobOf(flags, is_summary);
  if (!job.ok()) return Fail(kExitBadInput, job.status());

  const std::vector<absl::StatusOr<SummarySet>> sets = SummarizeInputs(*job, is_summary);
  int num_failed = 0;
  const absl::StatusOr<SummarySet> sum = SumOf(sets, flags.inputs, &num_failed);
  if (!sum.ok()) return Fail(kExitBadInput, sum.status());
  absl::Status status = CheckHeld(flags.fit, sum->options);
  if (status.ok()) {
    status = WriteSummaryFile(flags.output_path, *sum, absl::StrCat("lightfit ", kVersion));
  }
  if (!status.ok()) return Fail(kExitBadInput, status);
  if (!flags.fit.quiet) std::fputs(ReportText(*sum).c_str(), stdout);
  std::fflush(stdout);
  const bool is_complete = PrintMissingFrames(*sum, sets, is_summary);
  if (!job->lights.empty()) {
    const absl::StatusOr<std::vector<ListedLight>> lights = ListFitLights(flags.fit);
    if (lights.ok()) num_failed += PrintUnusable(*lights, "summary");
  }
  return num_failed > 0 || !is_complete ? kExitIncomplete : kExitOk;
}

}  // namespace lightfit::cli
