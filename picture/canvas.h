// picture/canvas.h
//
// A page to draw on: filled rectangles, antialiased lines and dots, images; text by text.h.
// In:   colours in display space (sRGB values 0 ... 1), pixel coordinates, y down.
// Out:  its pixels, 8 bits per channel, to look at or to store (png.h).
//
// Cairo draws. A page that Cairo cannot hold stays empty, and WritePng() says why.
#pragma once

#include <cairo.h>

#include <Eigen/Core>
#include <memory>

#include "absl/types/span.h"
#include "picture/color.h"
#include "picture/image.h"

namespace lightfit {

// What Cairo can hold along a side, pixels.
inline constexpr int kMaxCanvasSide = 32767;

class Canvas {
 public:
  Canvas(int width, int height, Rgb background);
  explicit Canvas(const Image& image);

  int width() const { return width_; }
  int height() const { return height_; }

  // All drawing is clipped to the canvas. `opacity` is in 0 ... 1.
  void FillRectangle(int x, int y, int width, int height, Rgb color, float opacity = 1);
  void DrawImage(int x, int y, const Image& image);
  void DrawCanvas(int x, int y, const Canvas& canvas);

  // Pixel (i, j) covers [i, i + 1] x [j, j + 1]. Lines have round ends, and a polygon covers no
  // pixel twice. Nothing is drawn of a line or dot that is not finite.
  void DrawLine(const Eigen::Vector2d& from,
                const Eigen::Vector2d& to,
                double width_px,
                Rgb color,
                float opacity = 1);
  void DrawPolygon(absl::Span<const Eigen::Vector2d> corners,
                   double width_px,
                   Rgb color,
                   float opacity = 1);
  void DrawDot(const Eigen::Vector2d& center, double radius_px, Rgb color, float opacity = 1);

  // What has been drawn so far; black where Cairo has no pixels.
  Image ToImage() const;
  Rgb At(int x, int y) const;

  // For what draws through Cairo itself.
  cairo_t* context() const { return context_.get(); }
  cairo_surface_t* surface() const { return surface_.get(); }

 private:
  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };

  void SetColor(Rgb color, float opacity);
  // Adds what may be seen of the line to the current path.
  void AddLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width_px);
  void StrokePath(double width_px, Rgb color, float opacity);

  int width_, height_;
  std::unique_ptr<cairo_surface_t, Destroy> surface_;
  std::unique_ptr<cairo_t, Destroy> context_;
};

}  // namespace lightfit
