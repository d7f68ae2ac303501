// jobs/frames/frame_gaps.h
//
// Frames that a shot lacks between its first and its last.
// In:   frame numbers in ascending order.
// Out:  after which of them frames are missing, and which these are.
//
// Frames are a step apart, the largest that all of them fit: 2 for a shot on twos. Frames between
// frames that lie unevenly make no gap before a whole frame is missing.
#pragma once

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "base/frame_number.h"

namespace lightfit {

struct FrameGaps {
  FrameNumber step;                  // of the frames that are there
  std::vector<bool> is_after;        // by frame: whether the one before it is missing
  std::vector<std::string> missing;  // "1004", "1004-1006", in order
  int64_t num_missing = 0;
};

FrameGaps FindGaps(absl::Span<const FrameNumber> numbers);

// "frames 1004-1006 are missing"; the first of many. Empty without gaps.
std::string GapsText(const FrameGaps& gaps);

}  // namespace lightfit
