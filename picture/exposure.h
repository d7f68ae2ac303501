// picture/exposure.h
//
// How much a picture of shaded surfaces is brightened, so that a dark scene can be seen.
// In:   the colours of its surfaces.
// Out:  the same colours, brighter where their median is dark; never darker, black and white stay.
#pragma once

#include "absl/types/span.h"
#include "picture/color.h"

namespace lightfit {

class Exposure {
 public:
  // Leaves everything as it is.
  Exposure() = default;

  // For surfaces of these colours: their median luminance becomes that of a middle grey, if it is
  // below and that takes no more than a reasonable curve.
  static Exposure For(absl::Span<const Rgb> surfaces);

  Rgb operator()(Rgb color) const;

 private:
  float power_ = 1.0F;  // of each channel
};

}  // namespace lightfit
