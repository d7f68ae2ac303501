// jobs/shot/job.h
//
// What `lightfit shot` is to do: frames, lights, modes, options and where results go.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "geometry/clip.h"
#include "geometry/light.h"
#include "jobs/shot/frames.h"
#include "optimizer/tracking/tracker.h"
#include "partition/tracking/plan_tracker.h"

namespace lightfit {

enum class ShotMode {
  kPerFrame,  // every frame has its own best matrix
  kTracked,   // a matrix is kept while it is good enough: optimizer/tracking/tracker.h
  kPerShot    // one matrix for all frames: it never crawls
};

inline constexpr std::array<ShotMode, 3> kShotModes = {
    ShotMode::kPerFrame, ShotMode::kTracked, ShotMode::kPerShot};

// "per-frame", "tracked", "per-shot": in files, tables and folders.
const char* ShotModeName(ShotMode mode);

struct ShotJob {
  std::string name;  // of the shot
  std::vector<ShotFrame> frames;
  std::vector<Light> lights;  // those that move: somewhere

  // As they are in that frame, in the same order.
  const std::vector<Light>& LightsIn(size_t frame) const {
    return frames[frame].lights.empty() ? lights : frames[frame].lights;
  }

  // FailedPrecondition for a light that moves: one map for all frames cannot serve it. Known once
  // FindMotion() has looked at all frames; until then all stand still.
  void FindMotion();
  absl::Status StandsStill(size_t light) const {
    return motion.empty() ? absl::OkStatus() : motion[light];
  }
  std::vector<absl::Status> motion;

  std::array<bool, kShotModes.size()> modes = {true, true, true};  // by ShotMode
  bool Has(ShotMode mode) const { return modes[static_cast<size_t>(mode)]; }

  MapSize map = {1024, 1024};
  ClipConvention clip = ClipConvention::Vulkan();
  TrackerOptions tracker;  // TrackerOptions::fit is for all modes
  const FitOptions& fit() const { return tracker.fit; }

  // Where several maps for one light are wanted; of it PlanOptions::fit is `fit()`, and `map` does
  // not count.
  std::optional<PlanTrackerOptions> plans;

  // kPerShot, L1 metrics: times that the samples are weighed anew, in the shot's own map. >= 0.
  int rounds = 2;

  std::string folder;  // for results; it is there
  bool force = false;  // whether results that are there already are computed again
  int num_threads = 1;
  bool quiet = false;              // no progress bar
  std::vector<std::string> notes;  // for people, before the work: what is missing
};

// "map 1024 x 1024 texels", "up to 4 maps for each light, 1048576 texels in all".
std::string MapsText(const ShotJob& job);

// Where results go. A name that ends in a number keeps frames in order.
struct ShotPaths {
  std::string folder;

  std::string Result(ShotMode mode, const ShotFrame& frame) const;
  std::string Summary(const ShotFrame& frame) const;
  std::string SummaryKey(const ShotFrame& frame) const;
  std::string Shot() const;  // kPerShot: the matrices, once
  std::string Csv() const;
  std::string Plot() const;
};

}  // namespace lightfit
