// jobs/shot/judge.h
//
// A frame of a shot in memory, and how good matrices and plans are in it.
// In:   the frame's file; per light a matrix or plan, or why there is none; the frame before.
// Out:  ShotFit: these with their figures on this frame's samples, and their crawl.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "jobs/shot/answer.h"
#include "jobs/shot/result.h"
#include "optimizer/light_view.h"

namespace lightfit {

// Of a light that is not there in a frame.
absl::Status AbsentError(const std::string& light_name, FrameNumber number);

// Lights whose names are among `absent` are not there in that frame: their status says so.
void SetAbsent(const std::vector<std::string>& absent,
               FrameNumber number,
               const std::vector<Light>& lights,
               ReadbackFile* file);

// Reads and checks the frame.
absl::StatusOr<ReadbackFile> ReadFrame(const ShotJob& job, size_t frame);

// What the frame says of the job's lights, found once for whatever is asked of it: element l of the
// views belongs to job.LightsIn(frame)[l], or says why there is none. Refers to the job and the
// file's buffers, and stays where it is.
class FrameViews {
 public:
  FrameViews(const ShotJob& job, size_t frame, const absl::StatusOr<ReadbackFile>& file);
  FrameViews(const FrameViews&) = delete;
  FrameViews& operator=(const FrameViews&) = delete;

  const std::vector<Light>& lights() const { return lights_; }
  const absl::StatusOr<Surfaces>& surfaces() const { return surfaces_; }
  const absl::StatusOr<LightView>& operator[](size_t light) const { return views_[light]; }

 private:
  const std::vector<Light>& lights_;
  absl::StatusOr<Surfaces> surfaces_;
  std::vector<absl::StatusOr<LightView>> views_;
};

// What is looked up by a result of an earlier run.
ShotLookUps LookUpsOf(const ShotJob& job, const v1::FitResult& result);

// Of lights that have moved since there is no crawl: their shadows go over surfaces whatever texels
// do.
struct FrameBefore {
  const ReadbackFile* file = nullptr;  // null: there is none, or it is missing
  ShotLookUps look_ups;
};

// The frame before `frame`, whose file and look-ups these are, as far as it counts.
FrameBefore BeforeFrame(const ShotJob& job,
                        size_t frame,
                        const absl::StatusOr<ReadbackFile>& file_before,
                        ShotLookUps look_ups);

// Energies and footprints become those of EvaluateMatrix() and EvaluatePlan(), by one measure for
// all modes: over the edges that maps with the answer's border serve.
std::vector<absl::StatusOr<ShotFit>> JudgeFits(const ShotJob& job,
                                               const FrameViews& views,
                                               const ShotAnswers& answers,
                                               const FrameBefore& before);

}  // namespace lightfit
