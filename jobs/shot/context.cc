#include "jobs/shot/context.h"

#include <utility>

#include "base/parallel.h"
#include "base/text_file.h"
#include "io/summary_file.h"

namespace lightfit {
namespace {

bool HasKey(const std::string& path, const std::string& key) {
  const absl::StatusOr<v1::FitResult> result = ReadFitResultJson(path);
  return result.ok() && result->shot().key() == key;
}

bool HoldsText(const std::string& path, const std::string& text) {
  const absl::StatusOr<std::string> found = ReadTextFile(path);
  return found.ok() && *found == text;
}

}  // namespace

ShotContext::ShotContext(const ShotJob& job)
    : job(job),
      paths{job.folder},
      keys(ComputeShotKeys(job)),
      frame_status(job.frames.size()),
      ray_sums(job.frames.size()),
      has_summary_(job.frames.size(), 0) {
  for (const ShotMode mode : kShotModes) {
    rows[static_cast<size_t>(mode)].resize(job.frames.size());
    done_[static_cast<size_t>(mode)].assign(job.frames.size(), 0);
  }
  if (job.force) return;
  const auto num_frames = static_cast<int>(job.frames.size());
  ParallelFor(num_frames, 1, job.num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const ShotFrame& frame = job.frames[i];
      for (const ShotMode mode : kShotModes) {
        if (!job.Has(mode)) continue;
        done_[static_cast<size_t>(mode)][i] =
            HasKey(paths.Result(mode, frame), keys.Of(mode, i)) ? 1 : 0;
      }
      has_summary_[i] = MakesSummaries() && HoldsText(paths.SummaryKey(frame), keys.summaries[i]) &&
                                ReadSummaryFile(paths.Summary(frame)).ok()
                            ? 1
                            : 0;
    }
  });
  has_shot_ = HasKey(paths.Shot(), keys.shot);
}

bool ShotContext::NeedsFits(size_t frame) const {
  for (const ShotMode mode : {ShotMode::kPerFrame, ShotMode::kTracked}) {
    if (job.Has(mode) && !IsDone(mode, frame)) return true;
  }
  return false;
}

bool ShotContext::IsComplete(size_t frame) const {
  if (NeedsFits(frame)) return false;
  if (!job.Has(ShotMode::kPerShot)) return true;
  if (MakesSummaries() && !HasSummary(frame)) return false;
  return !has_shot_ || IsDone(ShotMode::kPerShot, frame);
}

absl::StatusOr<v1::FitResult> ShotContext::ReadDone(ShotMode mode, size_t frame) const {
  return ReadFitResultJson(paths.Result(mode, job.frames[frame]));
}

void ShotContext::WriteResult(ShotMode mode, size_t frame, const v1::FitResult& result) {
  Fail(WriteFitResultJson(paths.Result(mode, job.frames[frame]), result));
  KeepRows(mode, frame, result);
}

void ShotContext::KeepRows(ShotMode mode, size_t frame, const v1::FitResult& result) {
  rows[static_cast<size_t>(mode)][frame] = RowsOfResult(job, mode, frame, result);
}

void ShotContext::BeginProgress(int num_steps) {
  progress_ = std::make_unique<Progress>(num_steps, job.quiet);
}

void ShotContext::Step(const std::string& what) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (progress_ == nullptr) return;
  progress_->Begin(what);
  progress_->Advance();
}

void ShotContext::Skip(int num_steps) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (int i = 0; i < num_steps && progress_ != nullptr; ++i) progress_->Advance();
}

void ShotContext::AddNotes(size_t frame, const ReadbackFile& file) {
  const std::lock_guard<std::mutex> lock(mutex_);
  readback_notes_.Add(frame, job.frames[frame].path, file);
}

void ShotContext::NoteReadbacks() {
  for (std::string& warning : readback_notes_.Warnings()) notes.push_back(std::move(warning));
}

void ShotContext::Fail(const absl::Status& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.Update(status);
}

absl::Status ShotContext::status() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return status_;
}

}  // namespace lightfit
