// io/light_channels.h
//
// The channels of the lights in a read-back whose depth is found: shadow, facing, mapped.
// In:   the open file, the lights, what their channels are called.
// Out:  the bits of a ReadbackFile, and its status for each light.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "io/exr/channels.h"
#include "io/readback_exr.h"

namespace lightfit::internal {

// The part of the name format before and after "{light}".
struct NameFormat {
  std::string prefix, suffix;
};

// How the channels of lights are named.
struct NameFormats {
  NameFormat shadow, facing, mapped;
};

absl::StatusOr<NameFormats> ParseNameFormats(const ReadbackExrOptions& options);

// Names of the lights that have a channel of that format, in file order.
std::vector<std::string> LightsInFile(const ExrChannels& channels, const NameFormat& format);

// A file whose depth is found.
struct OpenReadback {
  ExrInput& exr;
  const ExrChannels& channels;
  ChannelId depth;
  std::string view;

  absl::StatusOr<std::optional<ChannelId>> Find(const std::string& name) const {
    return channels.Find(name, depth.part, view);
  }
};

// Reads the lights' channels into `file`, whose depth is there. Fails as a whole for the channel of
// all shadows only.
absl::Status ReadBits(const OpenReadback& open,
                      absl::Span<const Light> lights,
                      const NameFormats& formats,
                      const ReadbackExrOptions& options,
                      ReadbackFile& file);

}  // namespace lightfit::internal
