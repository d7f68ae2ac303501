// io/exr_input.h
//
// One OpenEXR file open for reading: its parts, and single channels laid out on the display window.
// In:   a path.
// Out:  headers (OpenImageIO's ImageSpec) and channels of display-window size.
// Role: the one place that includes OpenImageIO; internal to io/.
#pragma once

#include <OpenImageIO/imageio.h>

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

  const std::string& path() const { return path_; }
  int num_parts() const { return static_cast<int>(parts_.size()); }
  const OIIO::ImageSpec& part(int i) const { return parts_[i]; }

  // Size of the display window of a part, pixels.
  int width(int part) const { return parts_[part].full_width; }
  int height(int part) const { return parts_[part].full_height; }

  const std::string& name(ChannelId id) const { return parts_[id.part].channelnames[id.channel]; }
  std::string quoted_name(ChannelId id) const;  // for messages
  bool is_uint(ChannelId id) const;

  // The channel of that name in the given part, else in the first part that has it.
  std::optional<ChannelId> Find(absl::string_view name, int preferred_part) const;

  // The matrix attribute of that name, (r, c) the number 4 r + c as stored.
  std::optional<Eigen::Matrix4d> MatrixAttribute(int part, const std::string& name) const;

  // One channel, row-major over the display window, `outside` where the data window does not reach.
  // Half and float channels are read as float, UINT channels as uint32_t, never across.
  absl::StatusOr<std::vector<float>> ReadFloat(ChannelId id, float outside);
  absl::StatusOr<std::vector<uint32_t>> ReadUint(ChannelId id);

 private:
  ExrInput(std::string path, std::unique_ptr<OIIO::ImageInput> input)
      : path_(std::move(path)), input_(std::move(input)) {}

  template <typename T>
  absl::StatusOr<std::vector<T>> Read(ChannelId id, OIIO::TypeDesc type, T outside);

  std::string path_;
  std::unique_ptr<OIIO::ImageInput> input_;
  std::vector<OIIO::ImageSpec> parts_;
};

// UTF-8, as "\"Z\", \"shadow.key\", \"shadow.sun\"", cut short after a few dozen.
std::string QuotedList(const std::vector<std::string>& names);

}  // namespace lightfit::internal
