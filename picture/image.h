// picture/image.h
//
// Pixels that are computed one by one: shaded surfaces, footprints as colours.
// In:   colours in display space, pixel coordinates, y down.
// Out:  pixels(); a Canvas draws an image into a page, WritePng() stores a page.
//
// In floats, as a Canvas is not, so that many faint contributions add up and means are exact.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/types/span.h"
#include "picture/color.h"

namespace lightfit {

class Image {
 public:
  Image() = default;
  Image(int width, int height, Rgb background)
      : width_(width), height_(height), pixels_(static_cast<size_t>(width) * height, background) {}

  int width() const { return width_; }
  int height() const { return height_; }
  const Rgb& At(int x, int y) const { return pixels_[Index(x, y)]; }
  const std::vector<Rgb>& pixels() const { return pixels_; }
  std::vector<Rgb>& pixels() { return pixels_; }

  // Clipped to the image. `opacity` is in 0 ... 1.
  void Blend(int x, int y, Rgb color, float opacity = 1);

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * width_ + x; }

  int width_ = 0, height_ = 0;
  std::vector<Rgb> pixels_;
};

// Every pixel becomes a square of `factor` pixels.
Image Magnified(const Image& image, int factor);

// Every square of `factor` pixels becomes their mean; squares at the edges may be incomplete.
Image Reduced(const Image& image, int factor);

// How much shaded surfaces are brightened, so that a dark scene can be seen: never darker, black
// and white stay.
class Exposure {
 public:
  // Leaves everything as it is.
  Exposure() = default;

  // For surfaces of these colours: their median luminance becomes that of a middle grey, if it is
  // below and that takes no more than a reasonable curve.
  static Exposure For(absl::Span<const Rgb> surfaces);

  Rgb operator()(Rgb color) const;

 private:
  float power_ = 1.0F;  // of each channel
};

}  // namespace lightfit
