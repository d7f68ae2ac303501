#include "partition/published/equal_maps.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

absl::StatusOr<MapSize> EqualSquares(MapSize budget, int num_maps, double margin_texels) {
  const int64_t texels = int64_t{budget.width} * budget.height / num_maps;
  int64_t side = std::llround(std::sqrt(static_cast<double>(texels)));
  while (side * side > texels) --side;
  side = std::min<int64_t>(side, kMaxMapSide);
  if (!(static_cast<double>(side) > 2.0 * margin_texels) || side < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "map = %dx%d: %d equal maps of its texels have sides of %d, want more than twice the "
        "margin of %g; give more texels or ask for fewer maps",
        budget.width,
        budget.height,
        num_maps,
        side,
        margin_texels));
  }
  return MapSize{static_cast<int>(side), static_cast<int>(side)};
}

Eigen::Matrix4d WithMargin(const Eigen::Matrix4d& map_from_world,
                           MapSize size,
                           double margin_texels) {
  constexpr double kRounding = 1e-6;  // of the map's side: of a strong warp as well
  const double margin_u = margin_texels + kRounding * size.width;
  const double margin_v = margin_texels + kRounding * size.height;
  Eigen::Matrix4d inner_from_map = Eigen::Matrix4d::Identity();
  inner_from_map(0, 0) = 1.0 - 2.0 * margin_u / size.width;
  inner_from_map(1, 1) = 1.0 - 2.0 * margin_v / size.height;
  inner_from_map(0, 3) = margin_u;
  inner_from_map(1, 3) = margin_v;
  return inner_from_map * map_from_world;
}

absl::Status ValidateMargin(const char* scheme, double margin_texels) {
  if (margin_texels >= 0.0 && std::isfinite(margin_texels)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: margin_texels = %g, want finite and at least 0", scheme, margin_texels));
}

}  // namespace lightfit
