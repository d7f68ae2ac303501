// optimizer/figures/foretell_by_state.h
//
// The forecast of ForetellWrongShare() where the read-back knows which surfaces face the light.
// In:   Readback with the third state, PixelFootprints of the map.
// Out:  the share of the image's pixels that will be wrong.   math.md (13), (14)
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

// Requires readback.KnowsFacing(light.shadow_bit). What lies outside the map counts where the
// border is wrong about it, and what is likely to lie there unseen; without a border nothing does,
// as somebody else counts it. CancelledError once a StopScope says so.
absl::StatusOr<double> ForetellByState(const Readback& readback,
                                       const Light& light,
                                       const PixelFootprints& footprints,
                                       std::optional<Border> border);

// The same of each pixel into `image`, row-major, as large as the read-back; the outermost pixels
// and what lies unseen outside of the map are not in it.
absl::Status ForetellImageByState(const Readback& readback,
                                  const Light& light,
                                  const PixelFootprints& footprints,
                                  std::optional<Border> border,
                                  absl::Span<float> image);

}  // namespace lightfit
