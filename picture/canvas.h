// picture/canvas.h
//
// A small picture to draw on: filled rectangles, antialiased lines and dots, other pictures.
// In:   colours in display space (sRGB values 0 ... 1), pixel coordinates, y down.
// Out:  pixels(), and a PNG file through WritePng().
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"

namespace lightfit {

struct Rgb {
  float r = 0, g = 0, b = 0;
};

// 0xRRGGBB, as in a style sheet.
Rgb HexColor(uint32_t rgb);

// `a` at share = 0, `b` at share = 1.
Rgb Mix(Rgb a, Rgb b, float share);

class Canvas {
 public:
  Canvas(int width, int height, Rgb background);

  int width() const { return width_; }
  int height() const { return height_; }
  const Rgb& At(int x, int y) const { return pixels_[Index(x, y)]; }
  const std::vector<Rgb>& pixels() const { return pixels_; }
  std::vector<Rgb>& pixels() { return pixels_; }

  // All drawing is clipped to the canvas. `opacity` is in 0 ... 1.
  void Blend(int x, int y, Rgb color, float opacity = 1);
  void FillRectangle(int x, int y, int width, int height, Rgb color, float opacity = 1);
  void DrawImage(int x, int y, const Canvas& image);

  // Pixel (i, j) covers [i, i + 1] x [j, j + 1]. Antialiased by the distance to the shape's edge.
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

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * width_ + x; }

  int width_, height_;
  std::vector<Rgb> pixels_;
};

// Every pixel becomes a square of `factor` pixels.
Canvas Magnified(const Canvas& canvas, int factor);

// Every square of `factor` pixels becomes their mean; squares at the edges may be incomplete.
Canvas Reduced(const Canvas& canvas, int factor);

// 8 bits per channel. Goes through a temporary name, so that no half-written file is ever seen.
absl::Status WritePng(const Canvas& canvas, const std::string& path);

}  // namespace lightfit
