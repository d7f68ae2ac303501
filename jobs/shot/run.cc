#include "jobs/shot/run.h"

#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "base/output_file.h"
#include "base/text_file.h"
#include "jobs/shot/csv.h"
#include "jobs/shot/pipeline.h"
#include "jobs/shot/whole.h"

namespace lightfit {
namespace {

// A light that some frames have nothing of: the shot's map need not have room for its shadows
// there.
void NoteMissing(const SummarySet& sum, ShotContext* context) {
  for (const LightSummary& light : sum.lights) {
    if (light.num_frames_without == 0 || light.total.num_frames == 0) continue;
    context->notes.push_back(absl::StrCat("per-shot: light \"",
                                          light.name(),
                                          "\" is fitted to ",
                                          light.total.num_frames,
                                          " of ",
                                          light.num_frames(),
                                          " frames; the others have nothing of it, such as ",
                                          std::string(light.failure.message())));
  }
}

int NumFrameSteps(const ShotContext& context) {
  int num_steps = 0;
  for (size_t i = 0; i < context.job.frames.size(); ++i) {
    num_steps += MustReadFrame(context, i) ? 1 : 0;
  }
  return num_steps;
}

}  // namespace

absl::Status MakeShotFolders(const ShotJob& job) {
  std::vector<std::string> folders;
  for (const ShotMode mode : kShotModes) {
    if (job.Has(mode)) folders.push_back(absl::StrCat(job.folder, "/", ShotModeName(mode)));
  }
  if (job.Has(ShotMode::kPerShot) && !job.plans.has_value()) {
    folders.push_back(job.folder + "/summaries");
  }
  for (const std::string& folder : folders) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
      return absl::InvalidArgumentError(absl::StrCat(folder,
                                                     ": the folder cannot be made: ",
                                                     error.message(),
                                                     "; choose another with --output FOLDER"));
    }
    if (absl::Status status = CheckWritable("--output", folder + "/0001.json"); !status.ok()) {
      return status;
    }
  }
  return CheckWritable("--output", ShotPaths{job.folder}.Csv());
}

absl::Status RunShot(ShotContext* context) {
  const ShotJob& job = context->job;
  const bool has_whole = job.Has(ShotMode::kPerShot);
  context->BeginProgress(NumFrameSteps(*context) + (has_whole ? NumWholeShotSteps(*context) : 0));
  const absl::StatusOr<SummarySet> sum = FitFrames(context);
  context->NoteReadbacks();
  if (sum.ok() && has_whole) {
    if (context->MakesSummaries() && !context->HasShot()) NoteMissing(*sum, context);
    context->Fail(FitWholeShot(*sum, context));
  }
  context->Fail(sum.status());
  context->EndProgress();
  if (!context->status().ok()) return context->status();
  return WriteTextFileAtomically(context->paths.Csv(), ShotCsv(job, context->rows));
}

}  // namespace lightfit
