#include "geometry/map_size.h"

#include <algorithm>

#include "absl/strings/str_format.h"

namespace lightfit {

absl::Status ValidateMapSize(MapSize map, double margin_texels) {
  if (map.width < 1 || map.height < 1 || map.width > kMaxMapSide || map.height > kMaxMapSide) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "map = %dx%d, want 1 ... %d texels each way", map.width, map.height, kMaxMapSide));
  }
  if (2.0 * margin_texels >= std::min(map.width, map.height)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("options.margin_texels = %g leaves nothing of a map of %dx%d texels",
                        margin_texels,
                        map.width,
                        map.height));
  }
  return absl::OkStatus();
}

}  // namespace lightfit
