// optimizer/figures/foretell.h
//
// How many shadow pixels a matrix will get wrong, foretold from the read-back alone.
// In:   Readback, Light, a matrix, the size of its map and its border.
// Out:  the share of the image's pixels that will be wrong, with nearest texels and an ideal bias,
//       and which pixels; how far off that may be; what is wrong now, where the read-back says what
//       the drawn map says.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_options.h"

namespace lightfit {

// A pixel is shadowed as the centre of its texel is, which lies up to half a texel away, at any
// place of the pixel's own plane. What the read-back shows at that place tells how often the
// look-up is wrong:   math.md (13)
//  - with the third state (Readback::KnowsFacing()) by classes: the other side of an edge on the
//    same surface, a surface turned away, something that stands before or behind the place; with
//    weights measured by exact ray casting. What the map leaves outside although the border answers
//    it wrongly counts whole, and is guessed where the cover is as tight as the pixels are apart.
//  - without it by the difference of the shadow bits, interpolated on the same surface.
//
// In 0 ... 1. ForecastFactor() says how good it is; docs/defaults.md how that was measured.
// InvalidArgument for a read-back, light or matrix that cannot be used; CancelledError once a
// StopScope says so.
absl::StatusOr<double> ForetellWrongShare(const Readback& readback,
                                          const Light& light,
                                          const Eigen::Matrix4d& map_from_world,
                                          MapSize map,
                                          const SampleOptions& options = {},
                                          Border border = Border::kLit);

// The same of several maps of one light, of which each pixel asks the densest that holds it. Each
// matrix must be one of this light (MapFromRay()).
absl::StatusOr<double> ForetellWrongShare(const Readback& readback,
                                          const Light& light,
                                          absl::Span<const SizedMatrix> maps,
                                          const SampleOptions& options = {},
                                          Border border = Border::kLit);

// The same pixel by pixel, row-major, for pictures: how likely each is to be wrong, 0 ... 1. All
// pixels are looked at, whatever the size, but for the outermost where the read-back knows what
// faces the light; 0 where there is no surface, and never NaN. What lies outside the maps is
// counted by the read-back's own pixels: a finer cover, and what is likely to lie there unseen,
// belong to none of them.
absl::StatusOr<std::vector<float>> ForetellWrongImage(const Readback& readback,
                                                      const Light& light,
                                                      absl::Span<const SizedMatrix> maps,
                                                      const SampleOptions& options = {},
                                                      Border border = Border::kLit);

// On two lights of three the measured share is within this factor of the foretold one, either way.
double ForecastFactor(const Readback& readback, const Light& light);

// Two forecasts on one light and read-back that are within this factor of one another say "about
// the same": measured, the smaller one may be the larger.
inline constexpr double kSameForecast = 1.1;

// The share of pixels at which the map that was drawn with says other than the truth
// (Readback::mapped_bits), of all; nothing where the read-back does not say. Surfaces that are
// known to be turned away are right.
std::optional<double> MeasuredWrongShare(const Readback& readback, const Light& light);

}  // namespace lightfit
