#include "cli/summarize.h"

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
#include "cli/flags/frame_inputs.h"
#include "cli/summary_inputs.h"
#include "cli/summary_list.h"
#include "cli/unusable_lights.h"
#include "io/notes/readback_notes.h"
#include "jobs/add_summaries.h"
#include "jobs/fit_summary.h"
#include "jobs/shot/judge.h"
#include "optimizer/fit.h"
#include "wire/plan_proto.h"
#include "wire/result_json.h"

namespace lightfit::cli {
namespace {

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

// Of the read-backs, by their place among the inputs.
struct SharedNotes {
  std::mutex mutex;
  ReadbackNotes notes;
};

struct Job {
  const SummarizeFlags& flags;
  std::vector<SummaryInput> inputs;
  std::optional<MatricesByLight> weigh_by;

  bool HasReadbacks() const {
    return std::any_of(inputs.begin(), inputs.end(), [](const SummaryInput& input) {
      return !input.is_summary();
    });
  }
};

absl::StatusOr<Job> JobOf(const SummarizeFlags& flags) {
  absl::StatusOr<std::vector<SummaryInput>> inputs =
      ListSummaryInputs(flags.inputs, flags.output_path, flags.fit);
  if (!inputs.ok()) return inputs.status();
  Job job = {flags, *std::move(inputs), {}};
  if (flags.weigh_by_path.empty()) return job;
  if (!job.HasReadbacks()) {
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
                            const Light& light,
                            size_t light_index,
                            const std::string& frame) {
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

absl::StatusOr<SummarySet> SummarizeReadback(const Job& job,
                                             const FrameToSum& frame,
                                             size_t place,
                                             SharedNotes* notes) {
  if (!frame.exr.ok()) return frame.exr.status();
  const std::string& path = frame.path;
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(path, frame.lights, *frame.exr);
  if (!file.ok()) return file.status();
  if (absl::Status status = ValidateReadback(file->View()); !status.ok()) {
    return InFile(path, status);
  }
  {
    const std::lock_guard<std::mutex> lock(notes->mutex);
    notes->notes.Add(place, path, *file);
  }
  SetAbsent(frame.absent_lights, frame.number.value_or(FrameNumber{}), frame.lights, &*file);
  // Folders differ between the machines of a farm, and would make files differ.
  const std::string name = std::filesystem::path(path).filename().string();
  for (absl::Status& status : file->light_status) {
    status = absl::Status(status.code(), absl::StrReplaceAll(status.message(), {{path, name}}));
  }
  std::vector<LightSummary> lights;
  for (size_t i = 0; i < frame.lights.size(); ++i) {
    lights.push_back(SummarizeLight(job, *file, frame.lights[i], i, name));
  }
  return MakeSummarySet(
      job.flags.fit.options, std::move(lights), IdentityOf(file->View(), frame.number));
}

// Results in the order of the inputs.
std::vector<absl::StatusOr<SummarySet>> SummarizeInputs(const Job& job, SharedNotes* notes) {
  std::vector<absl::StatusOr<SummarySet>> sets(job.inputs.size());
  const auto count = static_cast<int>(sets.size());
  Progress progress(count, job.flags.fit.quiet);
  std::mutex progress_mutex;
  ParallelFor(count, /*chunk=*/1, NumProcessors(), [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const SummaryInput& input = job.inputs[i];
      sets[i] = input.is_summary()
                    ? ReadSummary(input.path, job.flags.fit.only)
                    : SummarizeReadback(job, *input.frame, static_cast<size_t>(i), notes);
      const std::lock_guard<std::mutex> lock(progress_mutex);
      progress.Begin(absl::StrCat("summarising ", input.path));
      progress.Advance();
    }
  });
  return sets;
}

// The sum of what could be read; what could not is named on stderr and counted.
absl::StatusOr<SummarySet> SumOf(const std::vector<absl::StatusOr<SummarySet>>& sets,
                                 const std::vector<SummaryInput>& inputs,
                                 int* num_failed) {
  SummaryAdder adder;
  for (size_t i = 0; i < sets.size(); ++i) {
    if (!sets[i].ok()) {
      PrintError(absl::StrCat("left out: ", sets[i].status().message()));
      ++*num_failed;
    } else if (absl::Status status = adder.Add(inputs[i].path, *sets[i]); !status.ok()) {
      return status;
    }
  }
  if (!adder.sum().has_value()) {
    return absl::InvalidArgumentError("no input could be used, so nothing is written");
  }
  for (const std::string& note : adder.Notes()) PrintWarning(note);
  return *adder.sum();
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
                        const std::vector<SummaryInput>& inputs) {
  bool is_complete = true;
  for (size_t l = 0; l < sum.lights.size(); ++l) {
    if (sum.lights[l].num_frames_without == 0) continue;
    bool is_new = false;
    for (size_t i = 0; i < sets.size(); ++i) {
      is_new = is_new || (!inputs[i].is_summary() && sets[i].ok() &&
                          sets[i]->lights[l].num_frames_without > 0);
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
  DeclareSummarizeFlags(app, flags.get());
  return [flags] { return RunSummarize(*flags); };
}

int RunSummarize(const SummarizeFlags& flags) {
  if (absl::Status status = CheckWritable("-o", flags.output_path); !status.ok()) {
    return Fail(kExitBadInput, status);
  }
  const absl::StatusOr<Job> job = JobOf(flags);
  if (!job.ok()) return Fail(kExitBadInput, job.status());

  SharedNotes notes;
  const std::vector<absl::StatusOr<SummarySet>> sets = SummarizeInputs(*job, &notes);
  PrintWarnings(notes.notes.Warnings());
  int num_failed = 0;
  const absl::StatusOr<SummarySet> sum = SumOf(sets, job->inputs, &num_failed);
  if (!sum.ok()) return Fail(kExitBadInput, sum.status());
  absl::Status status = CheckHeld(flags.fit, sum->options);
  if (status.ok()) {
    status = WriteSummaryFile(flags.output_path, *sum, absl::StrCat("lightfit ", kVersion));
  }
  if (!status.ok()) return Fail(kExitBadInput, status);
  if (!flags.fit.quiet) {
    const std::string origin = notes.notes.OriginText();
    if (!origin.empty()) std::printf("read-backs: %s\n", origin.c_str());
    std::fputs(ReportText(*sum).c_str(), stdout);
  }
  std::fflush(stdout);
  const bool is_complete = PrintMissingFrames(*sum, sets, job->inputs);
  if (job->HasReadbacks()) {
    const absl::StatusOr<std::vector<ListedLight>> lights = ListLightsOfAnyFrame(flags.fit);
    if (lights.ok()) num_failed += PrintUnusable(*lights, "summary");
  }
  if (num_failed == 0 && is_complete) return kExitOk;
  const bool has_samples =
      std::any_of(sum->lights.begin(), sum->lights.end(), [](const LightSummary& light) {
        return light.total.num_frames > 0;
      });
  return has_samples ? kExitIncomplete : kExitBadInput;
}

}  // namespace lightfit::cli
