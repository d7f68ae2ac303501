// io/exr/channels.h
//
// What the channels of an EXR file may be called, and which of them a name means.
// In:   an open file.
// Out:  every channel with its part and view; the channel that a name means.
//
// A name is CHANNEL, as the file writes it, or PART.CHANNEL, for files whose layers are parts with
// channels of the same names. The view of a stereo file may be left out of either: the name
// "depth.Z" is that of "depth.left.Z", and of "Z" in the parts "depth" and "depth.left", if the
// view is left.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "io/exr/input.h"

namespace lightfit::internal {

struct ExrChannel {
  ChannelId id;
  std::string name;  // without its view
  std::string part;  // likewise
  std::string view;  // empty: of no view in particular

  bool IsIn(absl::string_view of_view) const { return view.empty() || view == of_view; }
};

// Whether a name means a channel, and how it says so.
enum class NameMatch { kNone, kChannel, kPartAndChannel };

// Refers to the file.
class ExrChannels {
 public:
  explicit ExrChannels(const ExrInput& exr);

  const ExrInput& exr() const { return exr_; }
  const std::vector<ExrChannel>& all() const { return all_; }

  // Of all parts, in file order.
  const std::vector<std::string>& views() const { return views_; }

  NameMatch Match(const ExrChannel& channel, absl::string_view name) const;

  // The channel of `view` that the name means: CHANNEL in `near_part`, or else PART.CHANNEL, or
  // else CHANNEL in any other part. Nothing where there is none; InvalidArgument where there are
  // several.
  absl::StatusOr<std::optional<ChannelId>> Find(absl::string_view name,
                                                int near_part,
                                                absl::string_view view) const;

  // For messages: all channels, by part where there are several parts.
  std::string QuotedByPart() const;

 private:
  const ExrInput& exr_;
  std::vector<ExrChannel> all_;
  std::vector<std::string> views_;
};

// "\"Z\" of part \"fg\", \"Z\" of part \"bg\"", cut short after a few dozen; for messages.
std::string QuotedChannels(const ExrInput& exr, const std::vector<ChannelId>& channels);

}  // namespace lightfit::internal
