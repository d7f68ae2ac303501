// jobs/shot/frames.h
//
// The frames of a shot, in order, and what they are called.
// In:   a folder of EXR files, a text file that lists them, or the files themselves.
// Out:  FrameList.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "io/readback_exr.h"

namespace lightfit {

struct ShotFrame {
  std::string path;
  std::string name;    // of the file, without folder and extension; results are named after it
  int64_t number = 0;  // on the time line

  // How it is to be read, or why it cannot be: its camera is missing, say.
  absl::StatusOr<ReadbackExrOptions> exr = ReadbackExrOptions();
};

struct FrameList {
  std::string shot;  // the name of the folder, or of the list
  std::vector<ShotFrame> frames;
};

// One folder (its *.exr in natural order), one list (a path per line, relative to the list; empty
// lines and those that start with # do not count), or EXR files in the order given. InvalidArgument
// or NotFound when that makes no frame.
//
// Where files have the same name, frames are called 0001, 0002 and so on. Numbers are the digits at
// the end of the names where they rise from frame to frame, else 1, 2 and so on.
absl::StatusOr<FrameList> ListFrames(const std::vector<std::string>& inputs);

// Whether `a` comes before `b` as people count: "frame9" before "frame10".
bool NaturalLess(absl::string_view a, absl::string_view b);

}  // namespace lightfit
