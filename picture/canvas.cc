#include "picture/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace lightfit {
namespace {

uint32_t PackedPixel(const Rgb& color) {
  const auto byte = [](float value) {
    return static_cast<uint32_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
  };
  return 0xff000000u | byte(color.r) << 16 | byte(color.g) << 8 | byte(color.b);
}

// Row `y` of a surface of CAIRO_FORMAT_RGB24: one word per pixel, 0xXXRRGGBB.
uint32_t* RowOf(cairo_surface_t* surface, int y) {
  unsigned char* data = cairo_image_surface_get_data(surface);
  // Cairo aligns rows to words.
  return reinterpret_cast<uint32_t*>(data + static_cast<ptrdiff_t>(y) *
                                                cairo_image_surface_get_stride(surface));
}

// The part of the line within `reach` of [0, width] x [0, height]. Cairo's coordinates are fixed
// point numbers of 24 bits before the point: what is farther away would wrap around.
std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> ClippedLine(const Eigen::Vector2d& from,
                                                                       const Eigen::Vector2d& to,
                                                                       const Eigen::Vector2d& size,
                                                                       double reach) {
  const Eigen::Vector2d along = to - from;
  if (!from.allFinite() || !along.allFinite()) return std::nullopt;
  double enter = 0, leave = 1;  // shares of the line
  for (int axis = 0; axis < 2; ++axis) {
    const double low = -reach - from[axis], high = size[axis] + reach - from[axis];
    if (along[axis] == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    const double at_low = low / along[axis], at_high = high / along[axis];
    enter = std::max(enter, std::min(at_low, at_high));
    leave = std::min(leave, std::max(at_low, at_high));
  }
  if (!(enter <= leave)) return std::nullopt;
  // What comes from very far comes rounded.
  const auto point = [&](double share) -> Eigen::Vector2d {
    return (from + share * along).array().max(-reach).min(size.array() + reach).matrix();
  };
  return std::pair<Eigen::Vector2d, Eigen::Vector2d>(point(enter), point(leave));
}

}  // namespace

Canvas::Canvas(int width, int height, Rgb background)
    : width_(width),
      height_(height),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      context_(cairo_create(surface_.get())) {
  SetColor(background, 1);
  cairo_paint(context_.get());
}

Canvas::Canvas(const Image& image) : Canvas(image.width(), image.height(), Rgb()) {
  DrawImage(0, 0, image);
}

void Canvas::SetColor(Rgb color, float opacity) {
  cairo_set_source_rgba(context_.get(), color.r, color.g, color.b, opacity);
}

void Canvas::FillRectangle(int x, int y, int width, int height, Rgb color, float opacity) {
  SetColor(color, opacity);
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_fill(context_.get());
}

void Canvas::DrawImage(int x, int y, const Image& image) {
  cairo_surface_flush(surface_.get());
  if (cairo_image_surface_get_data(surface_.get()) == nullptr) return;
  const int x_end = std::min(width_, x + image.width());
  for (int row = std::max(y, 0); row < std::min(height_, y + image.height()); ++row) {
    uint32_t* const pixels = RowOf(surface_.get(), row);
    for (int column = std::max(x, 0); column < x_end; ++column) {
      pixels[column] = PackedPixel(image.At(column - x, row - y));
    }
  }
  cairo_surface_mark_dirty(surface_.get());
}

void Canvas::DrawCanvas(int x, int y, const Canvas& canvas) {
  cairo_set_source_surface(context_.get(), canvas.surface(), x, y);
  cairo_rectangle(context_.get(), x, y, canvas.width(), canvas.height());
  cairo_fill(context_.get());
}

void Canvas::AddLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width_px) {
  const auto line = ClippedLine(from, to, {width_, height_}, width_px + 1);
  if (!line.has_value()) return;
  cairo_move_to(context_.get(), line->first.x(), line->first.y());
  cairo_line_to(context_.get(), line->second.x(), line->second.y());
}

void Canvas::StrokePath(double width_px, Rgb color, float opacity) {
  SetColor(color, opacity);
  cairo_set_line_width(context_.get(), width_px);
  cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);
  cairo_stroke(context_.get());
}

void Canvas::DrawLine(const Eigen::Vector2d& from,
                      const Eigen::Vector2d& to,
                      double width_px,
                      Rgb color,
                      float opacity) {
  AddLine(from, to, width_px);
  StrokePath(width_px, color, opacity);
}

void Canvas::DrawPolygon(absl::Span<const Eigen::Vector2d> corners,
                         double width_px,
                         Rgb color,
                         float opacity) {
  for (size_t i = 0; i < corners.size(); ++i) {
    AddLine(corners[i], corners[(i + 1) % corners.size()], width_px);
  }
  StrokePath(width_px, color, opacity);
}

void Canvas::DrawDot(const Eigen::Vector2d& center, double radius_px, Rgb color, float opacity) {
  // A line without length is a dot; it is clipped like any other.
  DrawLine(center, center, 2 * radius_px, color, opacity);
}

Rgb Canvas::At(int x, int y) const {
  cairo_surface_flush(surface_.get());
  if (cairo_image_surface_get_data(surface_.get()) == nullptr) return {};
  return HexColor(RowOf(surface_.get(), y)[x]);
}

Image Canvas::ToImage() const {
  Image image(width_, height_, {});
  cairo_surface_flush(surface_.get());
  if (cairo_image_surface_get_data(surface_.get()) == nullptr) return image;
  for (int y = 0; y < height_; ++y) {
    const uint32_t* const pixels = RowOf(surface_.get(), y);
    for (int x = 0; x < width_; ++x) image.Blend(x, y, HexColor(pixels[x]));
  }
  return image;
}

}  // namespace lightfit
