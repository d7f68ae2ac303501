#include "render/texel_maps.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace lightfit {

namespace {

class CastHits : public TexelHits {
 public:
  CastHits(const RayCaster& caster, const TexelMaps& maps, std::vector<double> first)
      : caster_(caster), maps_(maps), first_(std::move(first)) {}

  double First(int32_t texel) const override { return first_[texel]; }

  bool HasBehind(int32_t texel, double resolution, double far) const override {
    // Along a surface single precision may find the first hit again a little further on; the exact
    // distance tells.
    constexpr int kMaxRepeats = 8;
    const std::optional<Ray> ray = maps_.RayOf(texel);
    const double first = first_[texel];
    double near = first + resolution;
    for (int i = 0; i < kMaxRepeats; ++i) {
      const Hit hit = caster_.FirstHit(*ray, near, far);
      if (!hit.is_surface()) return false;
      if (hit.distance > first + resolution) return hit.distance < far;
      near += std::max(resolution, near - first);
    }
    return false;
  }

 private:
  const RayCaster& caster_;
  const TexelMaps& maps_;
  std::vector<double> first_;
};

}  // namespace

std::unique_ptr<TexelHits> TexelMaps::Draw(const RayCaster& caster,
                                           absl::Span<const uint8_t> wanted) const {
  constexpr int kChunk = 2048;
  std::vector<double> first(wanted.size(), std::numeric_limits<double>::infinity());
  const auto cast = [&](int begin, int end) {
    for (int texel = begin; texel < end; ++texel) {
      if (wanted[texel] == 0) continue;
      const std::optional<Ray> ray = RayOf(texel);
      if (ray.has_value()) first[texel] = caster.FirstHit(*ray).distance;
    }
  };
  ParallelFor(static_cast<int>(wanted.size()), kChunk, caster.num_threads(), cast);
  return std::make_unique<CastHits>(caster, *this, std::move(first));
}

}  // namespace lightfit
