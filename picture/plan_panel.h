// picture/plan_panel.h
//
// A plan of several maps, drawn: who asks which map, and what lands in each of them.
// In:   a read-back, a light, its Plan.
// Out:  the screen with a colour and a number for each map; a panel for each map, in its own shape.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"
#include "partition/plan.h"
#include "picture/canvas.h"
#include "picture/map_panel.h"
#include "picture/text.h"

namespace lightfit {

struct PlanView {
  static constexpr int kOutside = -1;    // a surface that no map may be asked about
  static constexpr int kNoSurface = -2;  // background

  std::vector<int> maps;       // that each pixel of the read-back asks, row-major
  std::vector<MapView> views;  // of each map, without a hull
  double outside_share = 0.0;  // of the surfaces, 0 ... 1
};

// `samples` as SampleImage() gives them; `guard_texels` as PlanLookUp has them. InvalidArgument for
// a plan that is none of the light's.
absl::StatusOr<PlanView> ViewPlan(const Readback& readback,
                                  const Light& light,
                                  const Plan& plan,
                                  double guard_texels,
                                  absl::Span<const uint8_t> samples);

// In the size of HeatPanelSize(): MapColor() of the map asked, darker in shadow, hatched grey
// outside of all maps, the shadow edges that were used in white, and where there is room for it the
// number of the map.
Canvas DrawCellsPanel(const Readback& readback,
                      const Light& light,
                      const PlanView& view,
                      absl::Span<const uint8_t> samples,
                      const Typeface& typeface);

// The stripes of what is outside of all maps, for a legend.
void DrawHatchedSquare(int x, int y, int size, Canvas* canvas);

// All maps in a canvas of that size, side by side, each in its own shape and colour, from its
// lowest number at the upper left.
Canvas DrawPlanMaps(
    const PlanView& view, const Plan& plan, int width, int height, const Typeface& typeface);

}  // namespace lightfit
