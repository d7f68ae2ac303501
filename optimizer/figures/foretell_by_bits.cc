#include "optimizer/figures/foretell_by_bits.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/scratch.h"
#include "base/stop.h"
#include "geometry/affine_depth.h"
#include "optimizer/figures/pixel_footprint.h"

namespace lightfit {

namespace {

// Large read-backs are looked at on a grid of about this many pixels.
constexpr int kMostPixels = 1 << 16;
// Places of the texel's centre in each direction, evenly spread.
constexpr int kPlaces = 3;
// A pixel belongs to the surface of another if its depth is off that one's plane by less than this
// share of the difference, or of the slope, or of the depth.
constexpr double kMostBend = 0.3;
constexpr double kDepthTolerance = 1e-3;

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
  // surface through (x, y); nothing where none does. Outside the image its edge continues.
  std::optional<double> At(const Eigen::Vector2d& place,
                           int x,
                           int y,
                           const DepthGradient& gradient) {
    const double column = std::clamp(place.x() - 0.5, 0.0, readback_.width() - 1.0);
    const double row = std::clamp(place.y() - 0.5, 0.0, readback_.height() - 1.0);
    const int left = std::min(static_cast<int>(column), readback_.width() - 2);
    const int top = std::min(static_cast<int>(row), readback_.height() - 2);
    double sum_weight = 0.0, sum = 0.0;
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        const double weight = (i == 1 ? column - left : 1.0 - (column - left)) *
                              (j == 1 ? row - top : 1.0 - (row - top));
        if (weight <= 0.0 || !IsOnSurface(left + i, top + j, x, y, gradient) ||
            !FacesLight(left + i, top + j)) {
          continue;
        }
        sum_weight += weight;
        sum += weight * Bit(left + i, top + j);
      }
    }
    constexpr double kLeastWeight = 1e-9;
    if (sum_weight < kLeastWeight) return std::nullopt;
    return sum / sum_weight;
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * readback_.width() + x; }

  bool IsOnSurface(int px, int py, int x, int y, const DepthGradient& gradient) const {
    const double depth = readback_.depth[Index(px, py)];
    if (!affine_depth_.IsSurface(depth)) return false;
    const double rise = affine_depth_.At(px, py, depth) - gradient.d;
    const double expected = (px - x) * gradient.d_x + (py - y) * gradient.d_y;
    const double slope = std::abs(gradient.d_x) + std::abs(gradient.d_y);
    return std::abs(rise - expected) <=
           kMostBend * std::max(std::abs(rise), slope) + kDepthTolerance * std::abs(gradient.d);
  }

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

}  // namespace

absl::StatusOr<double> ForetellByBits(const Readback& readback,
                                      const Light& light,
                                      const PixelFootprints& footprints,
                                      MapSize map,
                                      std::optional<Border> border) {
  ShadowOfSurface shadow(readback, footprints, light.shadow_bit);
  const double num_pixels = static_cast<double>(readback.width()) * readback.height();
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(num_pixels / kMostPixels))));
  double sum = 0.0;
  int64_t num_looked_at = 0;
  for (int y = stride / 2; y < readback.height(); y += stride) {
    if (absl::Status status = CheckStop(light); !status.ok()) return status;
    for (int x = stride / 2; x < readback.width(); x += stride) {
      ++num_looked_at;
      const std::optional<PixelFootprint> pixel = footprints.At(x, y);
      if (!pixel.has_value()) continue;
      const double bit = shadow.Bit(x, y);
      const Eigen::Vector2d& texel = pixel->texel;
      if (pixel->is_behind || texel.x() < 0.0 || texel.y() < 0.0 || texel.x() > map.width ||
          texel.y() > map.height) {
        if (border.has_value()) sum += *border == Border::kDark ? 1.0 - bit : bit;
        continue;
      }
      double wrong = 0.0;
      for (int j = 0; j < kPlaces; ++j) {
        for (int i = 0; i < kPlaces; ++i) {
          const Eigen::Vector2d delta((i + 0.5) / kPlaces - 0.5, (j + 0.5) / kPlaces - 0.5);
          const Eigen::Vector2d place =
              Eigen::Vector2d(x + 0.5, y + 0.5) + pixel->J_screen_map * delta;
          const std::optional<double> there = shadow.At(place, x, y, pixel->gradient);
          if (there.has_value()) wrong += std::abs(*there - bit);
        }
      }
      sum += wrong / (kPlaces * kPlaces);
    }
  }
  return num_looked_at > 0 ? sum / static_cast<double>(num_looked_at) : 0.0;
}

}  // namespace lightfit
