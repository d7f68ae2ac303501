#include "optimizer/figures/foretell_by_bits.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/affine_depth.h"
#include "optimizer/figures/forecast_places.h"
#include "optimizer/figures/pixel_footprint.h"

namespace lightfit {

namespace {

class ShadowOfSurface {
 public:
  ShadowOfSurface(const Readback& readback, const PixelFootprints& footprints, int bit)
      : readback_(readback),
        footprints_(footprints),
        affine_depth_(footprints.affine_depth()),
        bit_(bit),
        facing_(readback.depth.size(), Facing::kUnknown) {}

  double Bit(int x, int y) const { return (readback_.shadow_bits[Index(x, y)] >> bit_) & 1u; }

  // The shadow at a place of the screen, interpolated between the pixels around it that lie on the
  // plane's surface; nothing where none does.
  std::optional<double> At(const Eigen::Vector2d& place, const PixelPlane& plane) {
    double sum_weight = 0.0, sum = 0.0;
    ForEachPixelAround(readback_, place, [&](int x, int y, double weight) {
      const double depth = readback_.depth[Index(x, y)];
      if (!affine_depth_.IsSurface(depth) ||
          !IsOnSurface(x, y, affine_depth_.At(x, y, depth), plane) || !FacesLight(x, y)) {
        return;
      }
      sum_weight += weight;
      sum += weight * Bit(x, y);
    });
    constexpr double kLeastWeight = 1e-9;
    if (sum_weight < kLeastWeight) return std::nullopt;
    return sum / sum_weight;
  }

 private:
  size_t Index(int x, int y) const { return readback_.Index(x, y); }

  // Surfaces that are turned away have no shadow to look up. Looked at once, when first asked for.
  // At the image's border no plane is known, which says nothing.
  bool FacesLight(int x, int y) {
    Facing& facing = facing_[Index(x, y)];
    if (facing == Facing::kUnknown) {
      const bool is_inner =
          x > 0 && y > 0 && x + 1 < readback_.width() && y + 1 < readback_.height();
      const bool is_away = Bit(x, y) == 0.0 && is_inner && !footprints_.At(x, y).has_value();
      facing = is_away ? Facing::kAway : Facing::kTowards;
    }
    return facing == Facing::kTowards;
  }

  enum class Facing : uint8_t { kUnknown, kTowards, kAway };

  const Readback& readback_;
  const PixelFootprints& footprints_;
  const AffineDepth& affine_depth_;
  int bit_;
  ScratchVector<Facing> facing_;
};

// How likely pixel (x, y) is to be wrong.
double WrongAt(const PixelFootprints& footprints,
               std::optional<Border> border,
               int x,
               int y,
               ShadowOfSurface* shadow) {
  const std::optional<PixelFootprint> pixel = footprints.At(x, y);
  if (!pixel.has_value()) return 0.0;
  const double bit = shadow->Bit(x, y);
  const Eigen::Vector2d& texel = pixel->texel;
  const MapSize map = footprints.size(std::max(0, pixel->map));
  if (pixel->is_behind || texel.x() < 0.0 || texel.y() < 0.0 || texel.x() > map.width ||
      texel.y() > map.height) {
    if (!border.has_value()) return 0.0;
    return *border == Border::kDark ? 1.0 - bit : bit;
  }
  const PixelPlane plane = {x, y, pixel->gradient};
  return MeanOverPlaces([&](const Eigen::Vector2d& delta) {
    const Eigen::Vector2d place = Eigen::Vector2d(x + 0.5, y + 0.5) + pixel->J_screen_map * delta;
    const std::optional<double> there = shadow->At(place, plane);
    return there.has_value() ? std::abs(*there - bit) : 0.0;
  });
}

}  // namespace

absl::StatusOr<double> ForetellByBits(const Readback& readback,
                                      const Light& light,
                                      const PixelFootprints& footprints,
                                      std::optional<Border> border) {
  ShadowOfSurface shadow(readback, footprints, light.shadow_bit);
  const int stride = ForecastStride(readback);
  double sum = 0.0;
  int64_t num_looked_at = 0;
  for (int y = stride / 2; y < readback.height(); y += stride) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    for (int x = stride / 2; x < readback.width(); x += stride) {
      ++num_looked_at;
      sum += WrongAt(footprints, border, x, y, &shadow);
    }
  }
  return num_looked_at > 0 ? sum / static_cast<double>(num_looked_at) : 0.0;
}

absl::Status ForetellImageByBits(const Readback& readback,
                                 const Light& light,
                                 const PixelFootprints& footprints,
                                 std::optional<Border> border,
                                 absl::Span<float> image) {
  ShadowOfSurface shadow(readback, footprints, light.shadow_bit);
  for (int y = 0; y < readback.height(); ++y) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    for (int x = 0; x < readback.width(); ++x) {
      const double wrong = WrongAt(footprints, border, x, y, &shadow);
      image[readback.Index(x, y)] = static_cast<float>(wrong);
    }
  }
  return absl::OkStatus();
}

}  // namespace lightfit
