// cli/flags/shot_flags.h
//
// The options of `lightfit shot` as they stand on the command line.
// In:   words; a wrong one is refused while parsing (exit code 1).
// Out:  ShotFlags, and the job that they ask for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/flags/fit_flags.h"
#include "jobs/shot/job.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

struct ShotFlags {
  std::vector<std::string> inputs;  // as ListFrames() takes them

  // Lights, channels, camera, map and method; FitFlags::frame is that of the first frame, others
  // count on from it by their numbers.
  FitFlags fit;

  bool per_frame = false, tracked = false, per_shot = false;  // none: all of them

  double stability = 0.5;  // 0 ... 1; what it stands for may be changed one by one:
  std::optional<double> replace_below;
  std::optional<int> update_every_frames;
  std::optional<double> cover_margin_percent;

  int rounds = ShotJob().rounds;
  std::string output;  // a folder; empty: ShotFolder()
  bool force = false;
  int num_threads = 0;  // 0: as many as there are processors
};

// Declares every option on `app`, to be parsed into `flags`, which must stay where it is.
void DeclareShotFlags(CLI::App* app, ShotFlags* flags);

// The rule by which a tracked matrix is kept, and in it how all modes fit.
TrackerOptions TrackerOptionsOf(const ShotFlags& flags);

// The same of plans; nothing where one map of each light is wanted.
std::optional<PlanTrackerOptions> PlanTrackerOptionsOf(const ShotFlags& flags);

// With the frames listed and the lights and cameras read. A camera that is missing is in its
// frame's status.
absl::StatusOr<ShotJob> MakeShotJob(const ShotFlags& flags);

}  // namespace lightfit::cli
