#include "picture/image.h"

#include <algorithm>

namespace lightfit {

void Image::Blend(int x, int y, Rgb color, float opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  Rgb& pixel = pixels_[Index(x, y)];
  pixel = Mix(pixel, color, opacity);
}

Image Magnified(const Image& image, int factor) {
  Image large(image.width() * factor, image.height() * factor, {});
  for (int y = 0; y < large.height(); ++y) {
    for (int x = 0; x < large.width(); ++x) {
      large.Blend(x, y, image.At(x / factor, y / factor));
    }
  }
  return large;
}

Image Reduced(const Image& image, int factor) {
  Image small((image.width() + factor - 1) / factor, (image.height() + factor - 1) / factor, {});
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      Rgb mean;
      float num_pixels = 0;
      for (int row = y * factor; row < std::min((y + 1) * factor, image.height()); ++row) {
        for (int column = x * factor; column < std::min((x + 1) * factor, image.width());
             ++column) {
          num_pixels += 1;
          mean = Mix(mean, image.At(column, row), 1 / num_pixels);
        }
      }
      small.Blend(x, y, mean);
    }
  }
  return small;
}

}  // namespace lightfit
