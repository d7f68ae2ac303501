// jobs/frames/frame_names.h
//
// The frame numbers in names of files.
// In:   names without folder and extension, of files that lie together.
// Out:  FrameName: the number, and the name around it, which files of one sequence share.
//
// The number is the last group of digits that stands by itself ("shot_1001_left", "shot.v02.1001")
// or at the end ("frame0007"), and no version (v02); where all names have the same groups, one that
// is not the same in all. Minus: shot.-002, shot_-002, -002, and shot-002 where there is a shot000
// beside it. Between frames: shot.1001.25, unless these digits look like a frame's own number
// (shot.2.1001).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "base/frame_number.h"

namespace lightfit {

struct FrameName {
  std::string series;  // the name with * for the number; the name itself where it has none
  std::optional<FrameNumber> number;
};

// Element i belongs to names[i].
std::vector<FrameName> ReadFrameNames(absl::Span<const std::string> names);

}  // namespace lightfit
