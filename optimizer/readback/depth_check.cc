#include "optimizer/readback/depth_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/affine_depth.h"

namespace lightfit {

namespace {

// Where values change from pixel to pixel by this share and bend by more than single precision
// rounds, planes tell.
constexpr double kLeastChange = 1e-3;
constexpr double kLeastBend = 1e-5;

// Pixels at which the one bends less than half as much as the other.
struct FlatPixels {
  int64_t by_value = 0, by_inverse = 0;
};

void Look(double before, double here, double after, FlatPixels* flat) {
  if (!(before > 0.0 && here > 0.0 && after > 0.0)) return;
  const double change = std::max(std::abs(before - here), std::abs(after - here)) / here;
  // Edges of things tell nothing.
  constexpr double kMostChange = 0.2;
  if (change < kLeastChange || change > kMostChange) return;
  const double value = std::abs(before + after - 2.0 * here) / here;
  const double inverse = std::abs(1.0 / before + 1.0 / after - 2.0 / here) * here;
  if (std::max(value, inverse) < kLeastBend) return;
  if (value < 0.5 * inverse) ++flat->by_value;
  if (inverse < 0.5 * value) ++flat->by_inverse;
}

}  // namespace

DepthDoubt DoubtOfDepth(const Readback& readback) {
  if (IsNdc(readback.depth_kind) || readback.camera.orthographic) return DepthDoubt::kNone;
  const AffineDepth affine_depth = AffineDepthOf(readback);
  int64_t num_ends = 0;
  for (const float depth : readback.depth) {
    if (depth == 0.0F || depth == 1.0F) ++num_ends;
    // NaN, infinity and the background say nothing; -1 and the like are not 0 ... 1 either.
    if (depth < 0.0F || (affine_depth.IsSurface(depth) && depth > 1.0F)) return DepthDoubt::kNone;
  }
  const int width = readback.width(), height = readback.height();
  const float* depth = readback.depth.data();
  const double num_pixels = static_cast<double>(width) * height;
  constexpr double kNumPlaces = 40000.0;
  const int step = std::max(1, static_cast<int>(std::sqrt(num_pixels / kNumPlaces)));
  FlatPixels flat;
  for (int y = 1; y + 1 < height; y += step) {
    for (int x = 1; x + 1 < width; x += step) {
      const float* at = depth + readback.Index(x, y);
      // Distances along the ray are so nearly, from one pixel to the next.
      Look(at[-1], at[0], at[1], &flat);
      Look(*(at - width), at[0], at[width], &flat);
    }
  }
  constexpr int64_t kEnough = 20;
  const int64_t told = flat.by_value + flat.by_inverse;
  if (told >= kEnough && flat.by_inverse > 2 * flat.by_value) return DepthDoubt::kNone;
  if (num_ends > 0) return DepthDoubt::kNormalized;
  return told >= kEnough && flat.by_value > 2 * flat.by_inverse ? DepthDoubt::kProjective
                                                                : DepthDoubt::kNone;
}

}  // namespace lightfit
