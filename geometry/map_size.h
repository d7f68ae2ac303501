// geometry/map_size.h
//
// The size of a shadow map, and the one limit on it.
#pragma once

#include "absl/status/status.h"

namespace lightfit {

struct MapSize {
  int width = 0;   // texels
  int height = 0;  // texels
};

// The largest width or height, texels: twice what any hardware takes today.
inline constexpr int kMaxMapSide = 65536;

// InvalidArgument for a size that no map can have, or of which the margin leaves nothing.
absl::Status ValidateMapSize(MapSize map, double margin_texels = 0.0);

}  // namespace lightfit
