// io/exr/depth.h
//
// Which channel of an EXR file is the depth, and of which view.
// In:   the channels of an open file; the names that the user gave, if any.
// Out:  the channel and its view.
//
// A channel is ranked by what it can be: one that stands beside X (and Y) in its layer is a
// component of a vector and no depth, like the only channel of a layer that is called a position, a
// normal or mist. Of those that are left
//   1. Z, without a layer, as the OpenEXR standard has it;
//   2. those called depth, zdepth and the like, and the Z or the only channel of a layer or part
//      that is called so (depth.V, Z in ViewLayer.Depth);
//   3. the Z of any other layer.
// Among equals a part called depth comes before others; two that are still equal are refused.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "io/exr/channels.h"

namespace lightfit::internal {

struct DepthChoice {
  ChannelId id;
  std::string view;  // depth, shadows and camera are of this one; empty in files without views
};

// `wanted` and `view` are the user's; empty: none. NotFound where no channel is a depth or of that
// name; InvalidArgument where several are, and where a file of several views is read without one.
// All of these name the channels and their parts.
absl::StatusOr<DepthChoice> ChooseDepth(const ExrChannels& channels,
                                        const std::string& wanted,
                                        const std::string& view);

}  // namespace lightfit::internal
