// picture/color.h
//
// A colour and what is done with it everywhere: named as in style sheets, mixed.
// In:   -
// Out:  colours in display space (sRGB values 0 ... 1).
#pragma once

#include <cstdint>

namespace lightfit {

struct Rgb {
  float r = 0, g = 0, b = 0;
};

// 0xRRGGBB, as in a style sheet.
inline Rgb HexColor(uint32_t rgb) {
  const auto channel = [rgb](int shift) {
    return static_cast<float>((rgb >> shift) & 0xff) / 255.0f;
  };
  return {channel(16), channel(8), channel(0)};
}

// `a` at share = 0, `b` at share = 1.
inline Rgb Mix(Rgb a, Rgb b, float share) {
  return {a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b)};
}

}  // namespace lightfit
