#include "picture/image.h"

#include <algorithm>
#include <cmath>

namespace lightfit {
namespace {

constexpr float kMiddleGrey = 0.4F;   // display space
constexpr float kLeastPower = 0.45F;  // of the curve: beyond, surfaces in shadow lose their form

float LuminanceOf(Rgb color) { return 0.2126F * color.r + 0.7152F * color.g + 0.0722F * color.b; }

}  // namespace

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

Exposure Exposure::For(absl::Span<const Rgb> surfaces) {
  Exposure exposure;
  if (surfaces.empty()) return exposure;
  std::vector<float> luminances;
  luminances.reserve(surfaces.size());
  for (const Rgb& color : surfaces) luminances.push_back(LuminanceOf(color));
  const auto middle = luminances.begin() + static_cast<ptrdiff_t>(luminances.size() / 2);
  std::nth_element(luminances.begin(), middle, luminances.end());
  if (!(*middle < kMiddleGrey)) return exposure;
  constexpr float kBlack = 1e-3F;
  exposure.power_ =
      std::clamp(std::log(kMiddleGrey) / std::log(std::max(*middle, kBlack)), kLeastPower, 1.0F);
  return exposure;
}

Rgb Exposure::operator()(Rgb color) const {
  if (power_ == 1.0F) return color;
  const auto brightened = [this](float value) { return std::pow(std::max(value, 0.0F), power_); };
  return {brightened(color.r), brightened(color.g), brightened(color.b)};
}

}  // namespace lightfit
