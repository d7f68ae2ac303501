// optimizer/figures/foretell_by_bits.h
//
// The forecast of ForetellWrongShare() from depth and shadow bits alone.
// In:   Readback, PixelFootprints of the map.
// Out:  the share of the image's pixels that will be wrong.   math.md (13)
#pragma once

#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "optimizer/figures/pixel_footprint.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// The mean over places of the texel's centre, and over pixels, of the difference between the
// pixel's shadow bit and the read-back's bits, interpolated on the same surface, at that place. To
// first order, for edges that are straight and far apart, that is math.md (12); where texels are
// larger than shadows it stays below twice their area. Outside the map what has not the border's
// bit is wrong, surfaces turned away by the depth's normals apart; without a border nothing is, as
// somebody else counts it. CancelledError once a StopScope says so.
absl::StatusOr<double> ForetellByBits(const Readback& readback,
                                      const Light& light,
                                      const PixelFootprints& footprints,
                                      std::optional<Border> border);

// The same of each pixel into `image`, row-major, as large as the read-back.
absl::Status ForetellImageByBits(const Readback& readback,
                                 const Light& light,
                                 const PixelFootprints& footprints,
                                 std::optional<Border> border,
                                 absl::Span<float> image);

}  // namespace lightfit
