// partition/shipped/equal_squares.h
//
// The size of maps that are all the same square, as engines keep them in an array of textures.
// In:   texels of all maps, how many maps.
// Out:  the largest side that the budget allows.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"

namespace lightfit {

// The largest square of which `num_maps` >= 1 have at most `max_texels` together. InvalidArgument
// when its side is below `least_side`.
absl::StatusOr<MapSize> EqualSquares(const Light& light,
                                     int64_t max_texels,
                                     int num_maps,
                                     int least_side = 1);

}  // namespace lightfit
