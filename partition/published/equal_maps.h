// partition/published/equal_maps.h
//
// A budget of texels split into equal square maps, as the published schemes have them.
// In:   a budget and a number of maps; a map's matrix.
// Out:  the side of the squares; the matrix with room for a filter around what it showed.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/map_size.h"

namespace lightfit {

// The largest square of which `num_maps` >= 1 have at most the texels of `budget`. InvalidArgument
// when that has no room for the margin on both sides.
absl::StatusOr<MapSize> EqualSquares(MapSize budget, int num_maps, double margin_texels);

// What the map showed, inside of a margin. The margin is a little more than asked for, so that
// receivers on the border of the body do not fall off by rounding.
Eigen::Matrix4d WithMargin(const Eigen::Matrix4d& map_from_world,
                           MapSize size,
                           double margin_texels);

// Checks that a margin is finite and at least 0. `scheme` begins the message.
absl::Status ValidateMargin(const char* scheme, double margin_texels);

}  // namespace lightfit
