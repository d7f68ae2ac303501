// optimizer/readback/depth_check.h
//
// Whether depths that are said to be distances can be such.
// In:   a read-back whose surfaces all lie within 0 ... 1.
// Out:  doubt.
//
// On a plane 1/z is affine on the screen, and so is a depth between clip planes: where the values
// themselves are, and their inverses are not, they are no distances. Values that are scaled to
// 0 ... 1 reach one of both. A scene that is small in its units does neither.
#pragma once

#include "optimizer/readback/readback.h"

namespace lightfit {

enum class DepthDoubt {
  kNone,
  kProjective,  // 1/z, or between clip planes
  kNormalized   // scaled to 0 ... 1; or one of the others, with a far plane in view
};

// Of a valid read-back.
DepthDoubt DoubtOfDepth(const Readback& readback);

}  // namespace lightfit
