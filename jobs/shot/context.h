// jobs/shot/context.h
//
// What the stages of a shot share: the job, what is done already, and where they report to.
// In:   ShotJob.
// Out:  rows by mode and frame, what is wrong with which frame, the first file that failed.
//
// Threads: Step() and Fail() are for any of them; rows, frame_status and ray_sums have an element
// for each frame, which the thread that works on the frame writes.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/progress.h"
#include "io/notes/readback_notes.h"
#include "jobs/shot/job.h"
#include "jobs/shot/key.h"
#include "jobs/shot/result.h"
#include "partition/ray_sum.h"

namespace lightfit {

// What one frame shows, by light, or why it shows nothing.
using FrameRaySums = std::vector<absl::StatusOr<RaySum>>;

class ShotContext {
 public:
  // Looks at what is in the job's folder, in parallel.
  explicit ShotContext(const ShotJob& job);

  const ShotJob& job;
  const ShotPaths paths;
  const ShotKeys keys;

  // What is there already with the right key.
  bool IsDone(ShotMode mode, size_t frame) const {
    return done_[static_cast<size_t>(mode)][frame] != 0;
  }
  bool HasSummary(size_t frame) const { return has_summary_[frame] != 0; }
  bool HasShot() const { return has_shot_; }

  // Whether kPerShot sums the frames up in summaries: a plan of several maps needs more than these.
  bool MakesSummaries() const { return job.Has(ShotMode::kPerShot) && !job.plans.has_value(); }

  // Whether what every frame shows is kept for kPerShot's plans, which are not there yet.
  bool SumsRays() const {
    return job.Has(ShotMode::kPerShot) && job.plans.has_value() && !HasShot();
  }

  // Whether all of the frame is there that can be while kPerShot has no matrices; whether a matrix
  // of its own, per frame or tracked, is missing.
  bool IsComplete(size_t frame) const;
  bool NeedsFits(size_t frame) const;

  // The result of a frame that is done.
  absl::StatusOr<v1::FitResult> ReadDone(ShotMode mode, size_t frame) const;

  // Writes the file and keeps its rows.
  void WriteResult(ShotMode mode, size_t frame, const v1::FitResult& result);
  void KeepRows(ShotMode mode, size_t frame, const v1::FitResult& result);

  void BeginProgress(int num_steps);
  void Step(const std::string& what);
  void Skip(int num_steps);
  void EndProgress() { progress_.reset(); }

  // What is to be said of a frame's read-back; and of all that were read, in `notes`.
  void AddNotes(size_t frame, const ReadbackFile& file);
  void NoteReadbacks();

  // Remembers the first status that is not ok; all work should end.
  void Fail(const absl::Status& status);
  absl::Status status() const;

  ShotRows rows;
  std::vector<absl::Status> frame_status;  // by frame: whether its file could be read
  std::vector<FrameRaySums> ray_sums;      // by frame: for the shot's plans, where SumsRays()
  std::vector<std::string> notes;          // for people

 private:
  std::array<std::vector<char>, kShotModes.size()> done_;
  std::vector<char> has_summary_;
  bool has_shot_ = false;

  mutable std::mutex mutex_;
  absl::Status status_;
  ReadbackNotes readback_notes_;
  std::unique_ptr<Progress> progress_;
};

}  // namespace lightfit
