// partition/published/least_error_warp.h
//
// How strong a warp along a body must be so that its largest error along itself is the least.
// In:      per corner of the body the place b along the warp and the width of a pixel there.
// Out:     1/n', n' the distance of the warp's centre from where the body begins; 0 is no warp.
// Symbols: L length of the body along b.
//
// Lloyd et al. 2006, 4.1: a texel's width along b is in proportion to (1 + b/n')^2 / (1 + L/n'),
// and its error M_v is largest at a corner. On a trapezoid whose pixels widen from w0 to w1 the
// least is at n' = L / (sqrt(w1/w0) - 1), their n'_L.   docs/published_plans.md (L1)
#pragma once

#include "absl/types/span.h"

namespace lightfit {

struct WarpCorner {
  double b = 0.0;            // 0 ... L
  double pixel_width = 1.0;  // > 0, in any unit
};

// L is the greatest b, and the body begins at 0. 0 where it has no length.
double LeastErrorWarp(absl::Span<const WarpCorner> corners);

}  // namespace lightfit
