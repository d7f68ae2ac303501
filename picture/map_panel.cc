#include "picture/map_panel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/convex_hull.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

constexpr int kReach = 26;              // pixels: no dot is larger
constexpr double kDensityRadius = 1.1;  // pixels
constexpr double kSampleRadius = 1.3;   // pixels
constexpr double kReceiverOpacity = 0.05;
constexpr double kMinReceiverOpacity = 0.004;
constexpr size_t kDenseReceivers = 300000;
constexpr float kSampleOpacity = 0.55f;
constexpr int kNumGridLines = 8;

// Where the map lies in the panel.
struct Frame {
  double left, top, scale;  // pixels, pixels, pixels per texel

  Eigen::Vector2d PixelOf(const Eigen::Vector2d& texel) const {
    return {left + scale * texel.x(), top + scale * texel.y()};
  }
};

Frame FrameFor(MapSize map, int size, int border_px) {
  Frame frame;
  frame.scale = (size - 2.0 * border_px) / std::max(map.width, map.height);
  frame.left = (size - frame.scale * map.width) / 2;
  frame.top = border_px;
  return frame;
}

// Whether a small dot there can be seen. A receiver may land anywhere, also where no int reaches.
bool IsInPanel(const Eigen::Vector2d& pixel, int size) {
  return pixel.minCoeff() > -kReach && pixel.maxCoeff() < size + kReach;
}

// Point clouds are drawn in floats, not by Cairo: a single receiver's share of a pixel is often
// less than one step of 8 bits. Antialiased by the distance to the dot's edge.
void BlendDot(
    const Eigen::Vector2d& center, double radius, Rgb color, float opacity, Image* image) {
  const double reach = radius + 1;
  const int x_end = static_cast<int>(std::ceil(center.x() + reach));
  const int y_end = static_cast<int>(std::ceil(center.y() + reach));
  for (int y = static_cast<int>(std::floor(center.y() - reach)); y < y_end; ++y) {
    for (int x = static_cast<int>(std::floor(center.x() - reach)); x < x_end; ++x) {
      const double distance = (Eigen::Vector2d(x + 0.5, y + 0.5) - center).norm();
      const double coverage = std::clamp(radius - distance + 0.5, 0.0, 1.0);
      image->Blend(x, y, color, opacity * static_cast<float>(coverage));
    }
  }
}

// Faint lines at equal numbers of texels, so that the eye can compare places.
void DrawGrid(const Frame& frame, MapSize map, Canvas* canvas) {
  for (int i = 1; i < kNumGridLines; ++i) {
    const double u = static_cast<double>(map.width) * i / kNumGridLines;
    const double v = static_cast<double>(map.height) * i / kNumGridLines;
    canvas->DrawLine(frame.PixelOf({u, 0}), frame.PixelOf({u, map.height}), 1, kRuleColor, 0.6f);
    canvas->DrawLine(frame.PixelOf({0, v}), frame.PixelOf({map.width, v}), 1, kRuleColor, 0.6f);
  }
}

// Dots laid over each other approach the full colour, so brightness follows density without a scale
// of its own; many receivers get a smaller share each, and need no round dots.
void BlendReceivers(const std::vector<Eigen::Vector2d>& receivers,
                    const Frame& frame,
                    Rgb color,
                    Image* image) {
  const int size = image->width();
  const double num_receivers = static_cast<double>(std::max<size_t>(receivers.size(), 1));
  const float opacity = static_cast<float>(
      std::clamp(kReceiverOpacity * size * size / num_receivers, kMinReceiverOpacity, 0.35));
  const bool is_dense = receivers.size() > kDenseReceivers;
  for (const Eigen::Vector2d& receiver : receivers) {
    const Eigen::Vector2d pixel = frame.PixelOf(receiver);
    if (!IsInPanel(pixel, size)) continue;
    if (is_dense) {
      image->Blend(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), color, 4 * opacity);
    } else {
      BlendDot(pixel, kDensityRadius, color, opacity, image);
    }
  }
}

}  // namespace

MapView ViewMap(absl::Span<const Eigen::Vector3d> receivers_in_world,
                absl::Span<const ReceiverRole> roles,
                const Eigen::Matrix4d& map_from_world,
                MapSize map) {
  MapView view;
  std::vector<Eigen::Vector2d> needed;
  view.receivers.reserve(receivers_in_world.size());
  for (size_t i = 0; i < receivers_in_world.size(); ++i) {
    const Eigen::Vector4d x_in_map = map_from_world * receivers_in_world[i].homogeneous();
    if (!(x_in_map.w() > 0)) continue;
    const Eigen::Vector2d texel = x_in_map.head<2>() / x_in_map.w();
    view.receivers.push_back(texel);
    if (roles[i].is_sample) view.samples.push_back(texel);
    if (roles[i].needs_room) needed.push_back(texel);
  }
  view.hull = ConvexHull(needed);
  view.hull_share = Area(view.hull) / (static_cast<double>(map.width) * map.height);
  return view;
}

Canvas DrawMapPanel(const MapView& view,
                    MapSize map,
                    int size,
                    const Typeface& typeface,
                    const MapPanelStyle& style) {
  Canvas canvas(size, size, kPageColor);
  const Frame frame = FrameFor(map, size, style.border_px);
  canvas.FillRectangle(static_cast<int>(frame.left),
                       static_cast<int>(frame.top),
                       static_cast<int>(frame.scale * map.width),
                       static_cast<int>(frame.scale * map.height),
                       kPanelColor);
  DrawGrid(frame, map, &canvas);

  Image image = canvas.ToImage();
  BlendReceivers(view.others, frame, kUnratedColor, &image);
  BlendReceivers(view.receivers, frame, style.receivers, &image);
  const float sample_opacity = view.samples.size() > 20000 ? kSampleOpacity / 2 : kSampleOpacity;
  for (const Eigen::Vector2d& sample : view.samples) {
    const Eigen::Vector2d pixel = frame.PixelOf(sample);
    if (!IsInPanel(pixel, size)) continue;
    BlendDot(pixel, kSampleRadius, style.samples, sample_opacity, &image);
  }
  canvas.DrawImage(0, 0, image);

  Polygon hull;
  for (const Eigen::Vector2d& corner : view.hull) hull.push_back(frame.PixelOf(corner));
  canvas.DrawPolygon(hull, 1.6, kHullColor, 0.9f);
  const double width = map.width, height = map.height;
  canvas.DrawPolygon({frame.PixelOf({0, 0}),
                      frame.PixelOf({width, 0}),
                      frame.PixelOf({width, height}),
                      frame.PixelOf({0, height})},
                     2,
                     style.outline);
  if (!style.has_labels) return canvas;

  const Eigen::Vector2d bottom = frame.PixelOf({width / 2, height});
  typeface.Draw(static_cast<int>(bottom.x()),
                static_cast<int>(bottom.y()) + 18,
                absl::StrCat(map.width, " x ", map.height, " texels"),
                {.size_px = 13, .color = kFaintTextColor, .anchor = Anchor::kMiddle},
                &canvas);
  const Eigen::Vector2d origin = frame.PixelOf({0, 0});
  typeface.Draw(static_cast<int>(origin.x()),
                static_cast<int>(origin.y()) - 7,
                "0, 0",
                {.size_px = 13, .color = kFaintTextColor},
                &canvas);
  return canvas;
}

}  // namespace lightfit
