#include "geometry/hull_interior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lightfit {

Slabs::Slabs(const Polygon& polygon, int across) : across_(across) {
  low_.fill(std::numeric_limits<double>::infinity());
  high_.fill(-std::numeric_limits<double>::infinity());
  if (polygon.size() < 3) return;
  begin_ = polygon[0](across);
  double end = begin_;
  for (const Eigen::Vector2d& vertex : polygon) {
    begin_ = std::min(begin_, vertex(across));
    end = std::max(end, vertex(across));
  }
  const double slabs_per_unit = kNumSlabs / (end - begin_);
  // No width, or so little or much that rounding makes nonsense of it: no point is recognised.
  if (!std::isfinite(slabs_per_unit) || !(slabs_per_unit > 0.0)) return;
  slabs_per_unit_ = slabs_per_unit;

  // Where the borders between slabs cross the polygon's two chains. As the chains are convex and
  // concave, the borders' values bound the slabs between them.
  std::array<double, kNumSlabs + 1> lower, upper;
  lower.fill(std::numeric_limits<double>::infinity());
  upper.fill(-std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d* from = &polygon[i];
    const Eigen::Vector2d* to = &polygon[i + 1 == polygon.size() ? 0 : i + 1];
    // Counter-clockwise, the lower chain runs towards +x and the left one towards -y.
    const bool is_lower = ((*to)(across) > (*from)(across)) == (across == 0);
    if ((*to)(across) < (*from)(across)) std::swap(from, to);
    const double run = (*to)(across) - (*from)(across);
    if (!(run > 0.0) || !std::isfinite(run)) continue;
    const double slope = ((*to)(1 - across) - (*from)(1 - across)) / run;
    const int first = static_cast<int>(std::ceil(((*from)(across)-begin_) * slabs_per_unit_));
    const int last = static_cast<int>(((*to)(across)-begin_) * slabs_per_unit_);
    for (int border = std::max(first, 0); border <= std::min(last, kNumSlabs); ++border) {
      (is_lower ? lower : upper)[border] =
          (*from)(1 - across) + slope * (begin_ + border / slabs_per_unit_ - (*from)(across));
    }
  }
  for (int slab = 0; slab < kNumSlabs; ++slab) {
    low_[slab] = std::max(lower[slab], lower[slab + 1]);
    high_[slab] = std::min(upper[slab], upper[slab + 1]);
  }
}

}  // namespace lightfit
