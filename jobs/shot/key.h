// jobs/shot/key.h
//
// Keys that tell whether a result of an earlier run is still what a run would compute.
// In:   ShotJob; the bytes of its files.
// Out:  a key for every frame and mode: equal when files, names, lights, cameras, options and
//       program version are.
//
// A key is the CRC-32 and the length of all that. What a result takes from the frames before goes
// into its key: the frame before for the crawl, all frames before for a tracked matrix.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "jobs/shot/job.h"

namespace lightfit {

struct ShotKeys {
  std::array<std::vector<std::string>, kShotModes.size()> frames;  // by ShotMode, by frame
  std::vector<std::string> summaries;                              // by frame
  std::string shot;                                                // of the matrices of kPerShot

  const std::string& Of(ShotMode mode, size_t frame) const {
    return frames[static_cast<size_t>(mode)][frame];
  }
};

// Reads every file once, in parallel. Files that cannot be read have a key as well; to read them
// again is to fail again.
ShotKeys ComputeShotKeys(const ShotJob& job);

}  // namespace lightfit
