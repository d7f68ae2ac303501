// methods/trapezoidal.h
//
// Trapezoidal shadow maps: the 80 % rule.
// In:   MethodInput; the depth in focus.
// Out:  the map of the trapezoid around the body, its short side towards the viewer.
//
// Martin & Tan 2004 (EGSR), "Anti-aliasing and continuity with trapezoidal shadow maps". The centre
// line joins the centres of the frustum's near and far faces as the light sees them. Top and base
// of the trapezoid are across it where the body begins and ends, L apart. Its sides go through a
// point of the line, eta in front of the top, chosen so that what is in focus, a distance D behind
// the top, comes to lie 80 % (s) of the way down the map:
//
//   eta = L D (1 - s) / (s L - D),       from  s = D (eta + L) / (L (eta + D)).
//
// The trapezoid becomes a square as in lispsm.h, with eta for n. In focus is the depth that
// divides the body's depths in equal ratios, sqrt(nearest furthest), if nothing else is asked for.
//
// Edge cases. D >= s L: what is in focus lies deep enough without a warp, and eta is infinite.
// D < 1 % of L: taken as 1 %, or the warp would be without limit. The light sees the near face
// inside the far one or the other way around ("duelling frusta"), the light is along the view, or
// the view is orthographic: the focused map, and the note says so.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct TrapezoidalOptions {
  std::optional<double> focus_depth;  // camera depth in focus, world units, > 0
  double focus_line = 0.8;            // how far down the map it lies, more than 0 and less than 1
};

absl::StatusOr<MethodMap> TrapezoidalMap(const MethodInput& input,
                                         const TrapezoidalOptions& options = {});

}  // namespace lightfit
