// jobs/shot/frames.h
//
// The frames of a shot, in order, and what they are called.
// In:   a folder of EXR files, a text file that lists them, patterns, or the files themselves.
// Out:  FrameList.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/frame_number.h"
#include "geometry/light.h"
#include "io/readback_exr.h"
#include "jobs/frames/natural_order.h"

namespace lightfit {

struct ShotFrame {
  std::string path;
  std::string name;    // of the file, without folder and extension; results are named after it
  FrameNumber number;  // on the time line
  bool is_after_gap = false;  // frames are missing before it: no step of one frame leads here

  // How it is to be read, or why it cannot be: its camera is missing, say.
  absl::StatusOr<ReadbackExrOptions> exr = ReadbackExrOptions();

  // Where lights move: those of ShotJob::lights as they are in this frame. Empty: as there.
  std::vector<Light> lights;
  std::vector<std::string> absent_lights;  // names of those that are not there in this frame
};

struct FrameList {
  std::string shot;  // the name of the folder, or of the list
  std::vector<ShotFrame> frames;
  bool is_numbered = false;  // whether numbers are the files' own, or just 1, 2 and so on

  // For people, each empty where there is nothing to say.
  std::string missing;    // "frames 1004-1006 are missing (3)"
  std::string apart;      // "frames are 2 apart, from 1001 to 1009"
  std::string reordered;  // "frames are taken in the order of their numbers, ..."
};

// One folder (its *.exr), one list (a path per line, relative to the list; empty lines and those
// that start with # do not count), EXR files, or patterns of them (jobs/frames/frame_pattern.h).
// Hidden files, such as ._1001.exr, are no frames. InvalidArgument or NotFound when that makes no
// frame.
//
// Frames have the numbers of their names (jobs/frames/frame_names.h), or where all files have one
// name those of their folders, or those of their headers (io/frames/exr_frame.h), and are in their
// order. InvalidArgument where two have the same number, and where names are of two sequences.
// Where there is no number frames are 1, 2 and so on: in natural order those of a folder, else as
// they were given.
absl::StatusOr<FrameList> ListFrames(const std::vector<std::string>& inputs);

// The number that one file's name says, or else its header.
std::optional<FrameNumber> NumberOfFile(const std::string& path);

}  // namespace lightfit
