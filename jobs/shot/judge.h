// jobs/shot/judge.h
//
// A frame of a shot in memory, and how good matrices are in it.
// In:   the frame's file; per light a matrix, or why there is none; the frame before.
// Out:  ShotFit: the matrices with their figures on this frame's samples, and their crawl.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "jobs/shot/result.h"
#include "optimizer/light_view.h"

namespace lightfit {

// By light: its matrix, and what look-ups outside the map find.
struct LightMap {
  Eigen::Matrix4d map_from_world;
  Border border = Border::kLit;
};
using LightMaps = std::vector<std::optional<LightMap>>;

// Reads and checks the frame.
absl::StatusOr<ReadbackFile> ReadFrame(const ShotFrame& frame, absl::Span<const Light> lights);

// What the frame says of the job's lights, found once for whatever is asked of it: element l of the
// views belongs to job.lights[l], or says why there is none. Refers to the job and the file's
// buffers, and stays where it is.
class FrameViews {
 public:
  FrameViews(const ShotJob& job, const absl::StatusOr<ReadbackFile>& file);
  FrameViews(const FrameViews&) = delete;
  FrameViews& operator=(const FrameViews&) = delete;

  const absl::StatusOr<Surfaces>& surfaces() const { return surfaces_; }
  const absl::StatusOr<LightView>& operator[](size_t light) const { return views_[light]; }

 private:
  absl::StatusOr<Surfaces> surfaces_;
  std::vector<absl::StatusOr<LightView>> views_;
};

// Calls `fit` for the lights that the file has a shadow of. The others get their own status, and
// all that of a file which could not be read.
TrackedMatrices FitReadable(absl::Span<const Light> lights,
                            const absl::StatusOr<ReadbackFile>& file,
                            const std::function<TrackedMatrices(absl::Span<const Light>)>& fit);

// The maps of those that have one; the same from a result of an earlier run.
LightMaps MapsOf(absl::Span<const absl::StatusOr<TrackedMatrix>> matrices);
LightMaps MapsOf(const ShotJob& job, const v1::FitResult& result);

struct FrameBefore {
  const ReadbackFile* file = nullptr;  // null: there is none
  LightMaps maps;
};

// Energies and footprints become those of EvaluateMatrix(), by one measure for all modes: over the
// edges that a map with the matrix's border serves.
std::vector<absl::StatusOr<ShotFit>> JudgeFits(
    const ShotJob& job,
    const FrameViews& views,
    absl::Span<const absl::StatusOr<TrackedMatrix>> matrices,
    const FrameBefore& before);

}  // namespace lightfit
