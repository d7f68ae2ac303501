// wire/summary_set.h
//
// What any number of read-backs have to say about their lights, and the sum of two of them.
// In:   summaries of read-backs, light by light.
// Out:  SummarySet, the same to the last bit in whatever order and grouping sets were added.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/energy/summary_total.h"
#include "optimizer/fit_options.h"
#include "wire/frame_identity.h"

namespace lightfit {

// One light in all the frames. Frames that have nothing of it are counted and stop nothing.
struct LightSummary {
  SummaryTotal total;  // of the frames that have something of it; maybe of none

  int64_t num_frames_without = 0;
  absl::Status failure;  // of those frames, the one whose message is alphabetically first

  // L1 metrics: the map in which the samples were weighed, as SummarizeInMap() takes it. Absent:
  // each frame's own best map.
  std::optional<Eigen::Matrix4d> weighed_in;

  const std::string& name() const { return total.light.name; }
  int64_t num_frames() const { return total.num_frames + num_frames_without; }
};

struct SummarySet {
  FitOptions options;                // what the samples were chosen and weighed by
  std::vector<LightSummary> lights;  // by name; all have the same number of frames

  // Which frames these are, in ascending order; fewer where files of programs that did not say so
  // have a part in it.
  std::vector<FrameIdentity> frames;

  int64_t num_frames() const { return lights.empty() ? 0 : lights.front().num_frames(); }
  int64_t num_unknown_frames() const { return num_frames() - static_cast<int64_t>(frames.size()); }
};

// Longer messages of failures are cut.
inline constexpr size_t kMaxFailureBytes = 1024;

// One frame's light, or why there is nothing of it; then `frame` goes before the message.
LightSummary SummaryOfFrame(const Light& light,
                            const absl::StatusOr<Summary>& summary,
                            absl::string_view frame,
                            const FitOptions& options);

// Puts the lights in order. They must be of the same frame, and have names of their own.
SummarySet MakeSummarySet(const FitOptions& options,
                          std::vector<LightSummary> lights,
                          const std::optional<FrameIdentity>& frame = std::nullopt);

// Adds `other` to `sum`. InvalidArgument, and `sum` as it was, unless lights, options and weighing
// are the same; the message has both values, those of `other` first. AlreadyExists, and as it was,
// when a frame is in both.
absl::Status AddToSet(const SummarySet& other, SummarySet* sum);

}  // namespace lightfit
