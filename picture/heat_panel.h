// picture/heat_panel.h
//
// The read-back coloured by the footprint of one matrix: where texels are fine, where coarse.
#pragma once

#include <cstdint>

#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"
#include "picture/canvas.h"
#include "picture/color_map.h"
#include "picture/image.h"
#include "picture/text.h"

namespace lightfit {

struct PanelSize {
  int width = 0;   // pixels
  int height = 0;  // pixels
};

// Small read-backs are magnified and large ones reduced, both by whole numbers.
PanelSize HeatPanelSize(const Readback& readback);

// `footprints` as FootprintImage() and `samples` as SampleImage() give them. Pixels in the light's
// shadow are darker, less so where most are; a white line runs along the shadow edges that were
// used.
Image DrawHeatPanel(const Readback& readback,
                    const Light& light,
                    absl::Span<const float> footprints,
                    absl::Span<const uint8_t> samples,
                    const LogScale& scale);

// The same of colours, one for each pixel of the read-back: in the size of the panel, darker in
// shadow, with the edges that were used. Pixels without a surface stay as they are.
Image DrawScreenPanel(const Readback& readback,
                      const Light& light,
                      Image colors,
                      absl::Span<const uint8_t> samples);

// The colours of the scale from bottom to top, with ticks and numbers at the right.
void DrawColorBar(
    int x, int y, int height, const LogScale& scale, const Typeface& typeface, Canvas* canvas);

}  // namespace lightfit
