// jobs/shot/result.h
//
// What came of one frame in one mode: as the JSON file that is kept, and as rows for table, CSV and
// plot.
// In:   per light a matrix or plan with its figures on this frame, or why there is none.
// Out:  v1::FitResult; from it, fresh or read back, ShotRow.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "io/readback_exr.h"
#include "jobs/shot/answer.h"
#include "jobs/shot/job.h"
#include "optimizer/figures/stability.h"
#include "optimizer/tracking/tracker.h"
#include "wire/result_json.h"

namespace lightfit {

struct ShotFit {
  ShotAnswer answer;
  Figures figures;             // on this frame's samples, foretold wrong pixels among them
  std::optional<Crawl> crawl;  // against the frame before, where both have an answer
};

// `fits[l]` belongs to light l of the job; `readback` is null when the frame could not be read, and
// then the key is left out, so that another run tries again. `states`: kTracked only; else none.
v1::FitResult ShotResultToProto(const ShotJob& job,
                                ShotMode mode,
                                size_t frame,
                                const std::string& key,
                                const ReadbackFile* readback,
                                absl::Span<const absl::StatusOr<ShotFit>> fits,
                                const ShotStates& states);

// What trackers remembered after a frame, of the lights that are the job's still. InvalidArgument
// when a number is none.
absl::StatusOr<ShotStates> StatesOf(const ShotJob& job, const v1::FitResult& result);

// One light in one frame in one mode.
struct ShotRow {
  ShotMode mode = ShotMode::kPerFrame;
  size_t frame = 0, light = 0;  // in ShotJob
  std::string error;            // why there is no answer; empty: there is
  std::string action;           // kTracked: TrackerActionName(), else empty
  int num_maps = 1;
  int num_moved = 1;  // maps whose texels moved over surfaces in this frame

  Border border = Border::kLit;  // of the map's sampler

  double energy = 0.0;
  FootprintStatistics footprint;  // read-back pixels per texel
  double wrong_share = 0.0;       // foretold, 0 ... 1
  std::optional<Crawl> crawl;
};

// By mode, frame and light; modes that were not asked for have frames without rows.
using ShotRows = std::array<std::vector<std::vector<ShotRow>>, kShotModes.size()>;

// One for each light.
std::vector<ShotRow> RowsOfResult(const ShotJob& job,
                                  ShotMode mode,
                                  size_t frame,
                                  const v1::FitResult& result);

}  // namespace lightfit
