#include "picture/heat_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/affine_depth.h"
#include "geometry/camera.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

constexpr int kMaxPanelWidth = 640;   // pixels
constexpr int kMaxPanelHeight = 560;  // pixels
constexpr float kShadowShare = 0.4f;  // of black, over pixels in shadow,
constexpr float kDimShare = 0.12f;    // ... where most are: a dark scene is to be seen as well
constexpr float kBoundaryOpacity = 0.9f;
constexpr int kBarWidth = 18;  // pixels

// How many panel pixels a read-back pixel becomes, or the other way round; one of the two is 1.
struct Zoom {
  int magnified = 1;
  int reduced = 1;
};

Zoom ZoomFor(int width, int height) {
  Zoom zoom;
  zoom.magnified = std::max(1, std::min(kMaxPanelWidth / width, kMaxPanelHeight / height));
  while (width > kMaxPanelWidth * zoom.reduced || height > kMaxPanelHeight * zoom.reduced) {
    ++zoom.reduced;
  }
  return zoom;
}

bool IsShadowed(const Readback& readback, const Light& light, size_t pixel) {
  return (readback.shadow_bits[pixel] >> light.shadow_bit) & 1u;
}

// How much darker pixels in shadow are: less, the more of the scene they are.
float ShadowShareOf(const Readback& readback, const Light& light, const AffineDepth& depth) {
  int64_t num_surfaces = 0, num_shadowed = 0;
  for (size_t pixel = 0; pixel < readback.depth.size(); ++pixel) {
    if (!depth.IsSurface(readback.depth[pixel])) continue;
    ++num_surfaces;
    num_shadowed += IsShadowed(readback, light, pixel) ? 1 : 0;
  }
  if (num_surfaces == 0) return kShadowShare;
  // Of the others some are turned away, in most scenes as many.
  constexpr double kSome = 0.3, kMost = 0.6;
  const double share = static_cast<double>(num_shadowed) / static_cast<double>(num_surfaces);
  const double dark = std::clamp((share - kSome) / (kMost - kSome), 0.0, 1.0);
  return kShadowShare + (kDimShare - kShadowShare) * static_cast<float>(dark);
}

// Calls mark(pixel, neighbour, is_right) for every lit and shadowed pair of neighbours of which one
// is a sample; `is_right` tells a right neighbour from the one below.
template <typename Mark>
void ForEachUsedEdge(const Readback& readback,
                     const Light& light,
                     absl::Span<const uint8_t> samples,
                     const Mark& mark) {
  const int width = readback.width();
  const auto visit = [&](size_t pixel, size_t neighbour, bool is_right) {
    if (!samples[pixel] && !samples[neighbour]) return;
    if (IsShadowed(readback, light, pixel) == IsShadowed(readback, light, neighbour)) return;
    mark(pixel, neighbour, is_right);
  };
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t pixel = static_cast<size_t>(y) * width + x;
      if (x + 1 < width) visit(pixel, pixel + 1, true);
      if (y + 1 < readback.height()) visit(pixel, pixel + width, false);
    }
  }
}

}  // namespace

PanelSize HeatPanelSize(const Readback& readback) {
  const Zoom zoom = ZoomFor(readback.width(), readback.height());
  const auto size = [&zoom](int pixels) {
    return (pixels * zoom.magnified + zoom.reduced - 1) / zoom.reduced;
  };
  return {size(readback.width()), size(readback.height())};
}

Image DrawHeatPanel(const Readback& readback,
                    const Light& light,
                    absl::Span<const float> footprints,
                    absl::Span<const uint8_t> samples,
                    const LogScale& scale) {
  const int width = readback.width();
  const AffineDepth depth = AffineDepthOf(readback);
  Image image(width, readback.height(), kPanelColor);
  for (size_t pixel = 0; pixel < footprints.size(); ++pixel) {
    if (!depth.IsSurface(readback.depth[pixel])) continue;
    image.pixels()[pixel] =
        footprints[pixel] > 0 ? scale.ColorOf(footprints[pixel]) : kUnratedColor;
  }
  return DrawScreenPanel(readback, light, std::move(image), samples);
}

Image DrawScreenPanel(const Readback& readback,
                      const Light& light,
                      Image image,
                      absl::Span<const uint8_t> samples) {
  const int width = readback.width();
  const AffineDepth depth = AffineDepthOf(readback);
  const float shadow_share = ShadowShareOf(readback, light, depth);
  for (size_t pixel = 0; pixel < samples.size(); ++pixel) {
    if (!depth.IsSurface(readback.depth[pixel]) || !IsShadowed(readback, light, pixel)) continue;
    image.pixels()[pixel] = Mix(image.pixels()[pixel], {}, shadow_share);
  }
  const Zoom zoom = ZoomFor(width, readback.height());
  if (zoom.magnified == 1) {
    // No room between the pixels: the sample pixels themselves are marked, after the reduction, so
    // that a line one pixel wide does not fade.
    Image panel = zoom.reduced > 1 ? Reduced(image, zoom.reduced) : image;
    for (size_t pixel = 0; pixel < samples.size(); ++pixel) {
      if (!samples[pixel]) continue;
      const int x = static_cast<int>(pixel % width) / zoom.reduced;
      const int y = static_cast<int>(pixel / width) / zoom.reduced;
      panel.Blend(x, y, kBoundaryColor, kBoundaryOpacity / static_cast<float>(zoom.reduced));
    }
    return panel;
  }
  Image panel = Magnified(image, zoom.magnified);
  ForEachUsedEdge(readback, light, samples, [&](size_t pixel, size_t, bool is_right) {
    const int x = static_cast<int>(pixel % width) * zoom.magnified;
    const int y = static_cast<int>(pixel / width) * zoom.magnified;
    const int last = zoom.magnified - 1;
    for (int along = 0; along <= last; ++along) {
      panel.Blend(x + (is_right ? last : along),
                  y + (is_right ? along : last),
                  kBoundaryColor,
                  kBoundaryOpacity);
    }
  });
  return panel;
}

void DrawColorBar(
    int x, int y, int height, const LogScale& scale, const Typeface& typeface, Canvas* canvas) {
  for (int row = 0; row < height; ++row) {
    const double position = 1 - (row + 0.5) / height;
    canvas->FillRectangle(x, y + row, kBarWidth, 1, scale.color_at(position));
  }
  for (const double tick : scale.Ticks()) {
    const bool is_one = std::abs(tick - 1) < 1e-9;
    const int tick_y = y + static_cast<int>(std::lround((1 - scale.Position(tick)) * (height - 1)));
    const Rgb color = is_one ? kTextColor : kFaintTextColor;
    if (is_one) canvas->FillRectangle(x - 4, tick_y - 1, kBarWidth + 4, 3, kTextColor);
    canvas->FillRectangle(x + kBarWidth, tick_y, 5, 1, color);
    typeface.Draw(x + kBarWidth + 9,
                  tick_y + 5,
                  TickLabel(tick),
                  {.size_px = is_one ? 16 : 14, .color = color, .bold = is_one},
                  canvas);
  }
}

}  // namespace lightfit
