// picture/color_map.h
//
// From a footprint to a colour: a logarithmic scale and the colours along it.
#pragma once

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "picture/color.h"

namespace lightfit {

// The colour at `position` in 0 ... 1, from deep blue (fine) over green to red (coarse). Lightness
// changes slowly and hue carries the value, so that a pixel may be darkened for another purpose.
Rgb HeatColor(double position);

// A logarithmic scale from `min` to `max`, 0 < min < max.
struct LogScale {
  double min = 0.1;
  double max = 10;

  // 0 at min, 1 at max, clamped.
  double Position(double value) const;

  // The values 1, 2 and 5 times powers of ten in the range, ascending.
  std::vector<double> Ticks() const;
};

// The scale that holds all but a few outliers of the positive values; its ends are 1, 2 or 5 times
// a power of ten. Zeros are ignored; no positive value gives the default scale.
LogScale ScaleFor(absl::Span<const float> values);

// 0.02, 0.5, 1, 20: a tick as people write it.
std::string TickLabel(double value);

}  // namespace lightfit
