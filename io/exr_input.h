// io/exr_input.h
//
// One OpenEXR file open for reading: its parts, and single channels laid out on the display window.
// In:   a path.
// Out:  what a read-back needs of the headers, and channels of display-window size.
// Role: the one place that reads through OpenEXR; internal to io/.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit::internal {

// A channel of a multi-part file.
struct ChannelId {
  int part = 0;
  int channel = 0;
};

class ExrInput {
 public:
  // Reads all headers. Refuses files that are not OpenEXR, deep parts, and parts whose windows hold
  // more than max_pixels; no pixel has been read or allocated by then.
  static absl::StatusOr<ExrInput> Open(const std::string& path, int64_t max_pixels);

  ~ExrInput();
  ExrInput(ExrInput&& other) noexcept;
  ExrInput& operator=(ExrInput&& other) noexcept;

  const std::string& path() const { return path_; }
  int num_parts() const { return static_cast<int>(parts_.size()); }

  // Size of the display window of a part, pixels.
  int width(int part) const;
  int height(int part) const;

  // Names in file order, which is that of the alphabet.
  const std::vector<std::string>& channels(int part) const { return parts_[part].channels; }
  const std::string& name(ChannelId id) const { return channels(id.part)[id.channel]; }
  std::string quoted_name(ChannelId id) const;  // for messages, with its part where there are more
  bool is_uint(ChannelId id) const { return parts_[id.part].is_uint[id.channel]; }

  // Of the header; empty where it has none.
  const std::string& part_name(int part) const { return parts_[part].name; }
  std::string quoted_part(int part) const;  // for messages; its number where it has no name

  // The views of a stereo file that the part's channels belong to, the default one first: one where
  // the part says `view`, several where it says `multiView`, and none in other files.
  const std::vector<std::string>& part_views(int part) const { return parts_[part].views; }

  // Width over height of a pixel, 1 where the part does not say.
  double pixel_aspect(int part) const;

  // The string attribute of that name.
  std::optional<std::string> StringAttribute(int part, const std::string& name) const;

  // The matrix attribute of that name, (r, c) the number 4 r + c as stored.
  std::optional<Eigen::Matrix4d> MatrixAttribute(int part, const std::string& name) const;

  // Names of the attributes that are 4 x 4 matrices.
  std::vector<std::string> MatrixNames(int part) const;

  // One channel, row-major over the display window, `outside` where the data window does not reach.
  // Half and float channels are read as float, UINT channels as uint32_t, never across; subsampled
  // channels are not read at all.
  absl::StatusOr<std::vector<float>> ReadFloat(ChannelId id, float outside);
  absl::StatusOr<std::vector<uint32_t>> ReadUint(ChannelId id);

 private:
  struct Source;  // OpenEXR's own
  struct Part {
    std::string name;
    std::vector<std::string> views;
    std::vector<std::string> channels;
    std::vector<bool> is_uint;
  };

  explicit ExrInput(std::string path);

  template <typename T>
  absl::StatusOr<std::vector<T>> Read(ChannelId id, T outside);

  std::string path_;
  std::unique_ptr<Source> source_;
  std::vector<Part> parts_;
};

// UTF-8, as "\"Z\", \"shadow.key\", \"shadow.sun\"", cut short after a few dozen.
std::string QuotedList(const std::vector<std::string>& names);

}  // namespace lightfit::internal
