#include "partition/shipped/equal_squares.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

absl::StatusOr<MapSize> EqualSquares(const Light& light,
                                     int64_t max_texels,
                                     int num_maps,
                                     int least_side) {
  const int64_t each = max_texels / num_maps;
  int64_t side = 0;
  if (each > 0) {
    side = std::min<int64_t>(std::llround(std::sqrt(static_cast<double>(each))), kMaxMapSide);
    while (side * side > each) --side;
  }
  if (side < least_side) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": max_texels = %d, want at least %d: %d squares of %dx%d",
                        light.name,
                        max_texels,
                        int64_t{num_maps} * least_side * least_side,
                        num_maps,
                        least_side,
                        least_side));
  }
  return MapSize{static_cast<int>(side), static_cast<int>(side)};
}

}  // namespace lightfit
