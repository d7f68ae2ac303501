// io/frames/light_frames.h
//
// Lights that move: a lights file that says where they are in which frame.
// In:   {"lights": [...], "frames": [{"frame": 1001, "lights": [{"name": "sun", ...}]}, ...]}, or
//       of a light itself {"name": "sun", "frames": [{"frame": 1001, "direction": [...]}, ...]};
//       frames are numbered as io/frames/frame_table.h says.
// Out:  the lights file of each frame, as io/lights_file.h reads it.
//
// What a frame says of a light stands in for what "lights" says of it; a light that is in neither
// is not there in that frame.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "base/frame_number.h"

namespace lightfit {

class LightFrames {
 public:
  // Whether the file says anything of lights by frame.
  static bool HasMovingLights(const google::protobuf::Struct& file);

  // Nothing where the lights stand still: the file is a plain one, or one of cameras as well, or no
  // lights file at all.
  static absl::StatusOr<std::optional<LightFrames>> Parse(absl::string_view json);
  static absl::StatusOr<std::optional<LightFrames>> Of(const google::protobuf::Struct& file);
  static absl::StatusOr<std::optional<LightFrames>> Read(const std::string& path);

  // One entry for each frame that the file speaks of: of all or of none the number.
  std::vector<std::optional<FrameNumber>> numbers() const;

  struct Frame {
    std::string json;                 // {"lights": [...]}, the same lights in the same order in all
    std::vector<std::string> absent;  // names of those that are not there; `json` has them too
  };
  absl::StatusOr<Frame> FrameOf(size_t entry) const;

 private:
  using LightsByName = std::map<std::string, google::protobuf::Value>;
  struct Entry {
    std::optional<FrameNumber> number;
    LightsByName lights;
  };

  LightFrames() = default;
  absl::Status AddFramesOfFile(const google::protobuf::Struct& file);
  absl::Status AddFramesOfLight(const std::string& name, const google::protobuf::Struct& light);
  Entry* EntryFor(const std::optional<FrameNumber>& number, size_t place);
  absl::Status AddName(const std::string& name);

  std::vector<std::string> names_;  // of all lights, in the order of the file
  LightsByName base_;               // what is said of them without a frame
  std::vector<Entry> entries_;
  std::map<FrameNumber, size_t> entry_of_;  // by number, of those that have one
  bool has_places_ = false;                 // whether any was without
};

}  // namespace lightfit
