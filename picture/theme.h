// picture/theme.h
//
// The colours of every picture that the command line draws: light on dark.
#pragma once

#include "picture/color.h"

namespace lightfit {

inline const Rgb kPageColor = HexColor(0x15181d);
inline const Rgb kPanelColor = HexColor(0x23272f);    // behind the map, and where nothing was hit
inline const Rgb kUnratedColor = HexColor(0x4a505c);  // a surface without a footprint
inline const Rgb kRuleColor = HexColor(0x3a414d);
inline const Rgb kTextColor = HexColor(0xe8eaee);
inline const Rgb kFaintTextColor = HexColor(0x9aa3b2);
inline const Rgb kWarningColor = HexColor(0xffb454);
inline const Rgb kGainColor = HexColor(0x7fd6a0);
inline const Rgb kReceiverColor = HexColor(0x8fb4e8);
inline const Rgb kSampleColor = HexColor(0xff9d3b);
inline const Rgb kHullColor = HexColor(0x5fe0c8);
inline const Rgb kBoundaryColor = HexColor(0xffffff);
inline const Rgb kFalseShadowColor = HexColor(0xff4d2e);  // dark that should be lit
inline const Rgb kLightLeakColor = HexColor(0x2ec4ff);    // lit that should be dark
inline const Rgb kCropColor = HexColor(0xffd75e);

// The maps of a plan, told apart by hue, also by who sees two of the three colours (after Okabe and
// Ito); from the eighth on paler, then darker. Every place that uses them writes the number too.
inline Rgb MapColor(int map) {
  constexpr uint32_t kHues[] = {
      0x56b4e9, 0xe69f00, 0x009e73, 0xcc79a7, 0xf0e442, 0xd55e00, 0x3a7fd5};
  constexpr int kNumHues = 7;
  const Rgb color = HexColor(kHues[map % kNumHues]);
  const int turn = map / kNumHues % 4;
  if (turn == 0) return color;
  if (turn == 3) return Mix(color, {}, 0.25f);
  return turn == 1 ? Mix(color, {1, 1, 1}, 0.5f) : Mix(color, {}, 0.45f);
}

}  // namespace lightfit
