#include "calls/request_fields.h"

#include <Eigen/LU>

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

absl::StatusOr<Eigen::Matrix4d> MapFromWorldOf(const v1::CandidateMatrix& candidate, MapSize map) {
  if (candidate.has_map_from_world()) {
    return MatrixFromProto(candidate.map_from_world(), "map_from_world");
  }
  if (!candidate.has_clip_from_world()) {
    return absl::InvalidArgumentError("want map_from_world or clip_from_world");
  }
  const absl::StatusOr<Eigen::Matrix4d> clip_from_world =
      MatrixFromProto(candidate.clip_from_world(), "clip_from_world");
  if (!clip_from_world.ok()) return clip_from_world.status();
  const absl::StatusOr<ClipConvention> clip = ClipOfRequest(candidate);
  if (!clip.ok()) return clip.status();
  return Eigen::Matrix4d(ClipFromMap(map, *clip).inverse() * *clip_from_world);
}

absl::Status StoppedError() { return absl::CancelledError("stopped before the search was done"); }

}  // namespace lightfit
