// jobs/frames/frame_pattern.h
//
// Patterns of file names, as renderers and shells write them.
// In:   "shot.%04d.exr", "shot.####.exr", "shot.$F4.exr", "shot.*.exr", also in folders' names.
// Out:  the files there are, and the frame numbers where the pattern says which digits these are.
//
//   %04d %d          printf
//   ####  @@@@       as many digits, one alone any number of them
//   $F4 $F ${F4}     also $FF, which may lie between frames: 1001.25
//   <F4> <F> <frame> <frame04> <UDIM> {frame} {frame:04d}
//   * ? [0-9]        any name, as in a shell; hidden files (.*) are not meant
//
// Digits are as many as the pattern says, or more without leading zeros; a minus may go before them
// and count among them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "base/frame_number.h"

namespace lightfit {

struct MatchedFile {
  std::string path;
  std::optional<FrameNumber> number;  // where the pattern marks it
};

// Whether it has any of these in it and is not the name of a file that is there.
bool IsFilePattern(const std::string& path);

// In the order of their names. NotFound names the pattern, the folder and what is in it.
absl::StatusOr<std::vector<MatchedFile>> FilesMatching(const std::string& pattern);

}  // namespace lightfit
