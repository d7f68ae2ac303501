#include "calls/request_fields.h"

#include "geometry/map_size.h"
#include "optimizer/light_view.h"

namespace lightfit {

absl::StatusOr<MapSize> MapSizeOfRequest(const v1::MapSize& map, const FitOptions& options) {
  const MapSize size = {map.width(), map.height()};
  if (absl::Status status = ValidateMapSize(size, options.margin_texels); !status.ok()) {
    return status;
  }
  return size;
}

absl::Status StoppedError() { return absl::CancelledError("stopped before the search was done"); }

}  // namespace lightfit
