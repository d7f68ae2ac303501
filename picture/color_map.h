// picture/color_map.h
//
// From a figure to a colour: a logarithmic scale and the colours along it.
// In:   the values that a picture shows.
// Out:  LogScale; of footprints always with 1 in its middle, so that blue is finer than a pixel and
//       red coarser in every picture.
#pragma once

#include <string>
#include <vector>

#include "absl/types/span.h"
#include "picture/color.h"

namespace lightfit {

// The colour at `position` in 0 ... 1, from deep blue (fine) over green to red (coarse). Lightness
// changes slowly and hue carries the value, so that a pixel may be darkened for another purpose.
Rgb HeatColor(double position);

// Of a footprint: from deep blue (fine) over pale grey in the middle to deep red (coarse).
Rgb FootprintColor(double position);

// A logarithmic scale from `min` to `max`, 0 < min < max.
struct LogScale {
  double min = 0.1;
  double max = 10;
  Rgb (*color_at)(double position) = &HeatColor;

  // 0 at min, 1 at max, clamped.
  double Position(double value) const;

  Rgb ColorOf(double value) const { return color_at(Position(value)); }

  // The values 1, 2 and 5 times powers of ten in the range, ascending.
  std::vector<double> Ticks() const;
};

// The scale that holds all but a few outliers of the positive values; its ends are 1, 2 or 5 times
// a power of ten. Zeros are ignored; no positive value gives the default scale.
LogScale ScaleFor(absl::Span<const float> values);

// A scale of footprints, from 1/n to n pixels per texel: n is 5, 10, 20, 50, the least that holds
// all but a few outliers. One for all panels of a picture.
LogScale FootprintScaleFor(absl::Span<const float> values);

// 0.02, 0.5, 1, 20: a tick as people write it.
std::string TickLabel(double value);

}  // namespace lightfit
