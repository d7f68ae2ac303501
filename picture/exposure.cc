#include "picture/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lightfit {
namespace {

constexpr float kMiddleGrey = 0.4F;   // display space
constexpr float kLeastPower = 0.45F;  // of the curve: beyond, surfaces in shadow lose their form

float LuminanceOf(Rgb color) { return 0.2126F * color.r + 0.7152F * color.g + 0.0722F * color.b; }

}  // namespace

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
