// io/frames/frame_table.h
//
// Which entry of a file's "frames" belongs to which frame of a shot.
// In:   a scene file's "frames": a list whose entries may have "frame": 1001, or an object by
// number
//       {"1001": {...}}; for a list also "frame_start": 1001 beside it. The frames of the shot.
// Out:  the entry of each frame; or why it cannot be known.
//
// The frame's number chooses, never its place among the files: some may be missing. Entries without
// numbers count from 0; they go with the shot's frames where there is one for each from the first
// to the last of these, missing ones included, or where somebody says which is the first one's.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "base/frame_number.h"

namespace lightfit {

struct FrameEntry {
  std::optional<FrameNumber> number;  // of all entries, or of none; distinct
  google::protobuf::Value value;
};

using FrameTable = std::vector<FrameEntry>;

// Whether the file has frames.
bool HasFrames(const google::protobuf::Struct& file);

// One entry or more.
absl::StatusOr<FrameTable> ReadFrameTable(const google::protobuf::Struct& file);

// The number that an entry itself states as "frame", "frame_number", "frameNumber" or "number".
absl::StatusOr<std::optional<FrameNumber>> StatedNumber(const google::protobuf::Struct& entry,
                                                        const std::string& where);

// What is known of the frames of a shot.
struct ShotNumbers {
  bool are_known = false;             // else `first` and `last` mean nothing
  FrameNumber first, last;            // of the shot
  std::optional<FrameNumber> stated;  // --frame: the entry of the first frame
};

// For the `number` of a frame, the number of the entry, or its place where entries have none, that
// belongs to it: element i belongs to entries[i] of the file. InvalidArgument: it cannot be known,
// or there is none.
class EntryChooser {
 public:
  // `what` for messages: "cameras", "lights".
  static absl::StatusOr<EntryChooser> Make(std::vector<std::optional<FrameNumber>> entries,
                                           const ShotNumbers& shot,
                                           const std::string& what);

  absl::StatusOr<size_t> EntryOf(FrameNumber number) const;

  // Whether the frames' own numbers choose, so that they must be right.
  bool GoesByNumber() const { return goes_by_number_; }

 private:
  EntryChooser() = default;

  std::vector<std::pair<FrameNumber, size_t>> entries_;  // in ascending order
  int64_t shift_ = 0;                                    // millionths, from frame to entry
  bool is_numbered_ = false, goes_by_number_ = false;
  std::string what_;
};

}  // namespace lightfit
