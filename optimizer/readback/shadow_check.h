// optimizer/readback/shadow_check.h
//
// Whether shadows can be those of a light, as far as the depth buffer shows what blocks it.
// In:   a read-back, one of its lights.
// Out:  how many lit and how many shadowed pixels have a visible surface between them and the
// light.
//
// A few hundred pixels that face the light are tried. From each the way to the light is a straight
// line on the screen, and so is its affine depth (math.md (11)): it is blocked where it goes
// through a surface that continues on both sides. What lies behind something, or outside the image,
// is not seen, so that shadows without a blocker say nothing; but a lit pixel with one contradicts
// the light or the shadows. Bits the wrong way round and lights of another scene show so.
#pragma once

#include "geometry/light.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct ShadowCheck {
  int num_lit = 0, num_lit_blocked = 0;
  int num_shadowed = 0, num_shadowed_blocked = 0;

  double LitBlockedShare() const;       // 0 without any
  double ShadowedBlockedShare() const;  // likewise
};

// Of a valid read-back and light.
ShadowCheck CheckShadows(const Readback& readback, const Light& light);

enum class ShadowVerdict {
  kPlausible,  // or not to be told
  kInverted,   // the blocked pixels are lit, and those in shadow are not blocked
  kOfAnother   // shadows have to do with some other light
};
ShadowVerdict VerdictOf(const ShadowCheck& check);

}  // namespace lightfit
