// partition/published/view_grid.h
//
// How large a plan's texels are on the screen, wherever in the view a receiver may be.
// In:   MethodInput; a plan of its light.
// Out:  points all over the body in view; the mean side of a texel there, pixels.
//
// Known without the picture, as the published schemes know none. Points lie on the view rays of a
// grid of the screen, between the nearest and the furthest that the clip planes, the receivers' box
// and the input's cuts leave, in equal ratios of depth. Each stands for a receiver that is turned
// to the light and to the eye alike: a texel is as large across the light's ray as across the view
// ray, so that all depends on distances, as in the papers' perspective aliasing, and nothing on how
// surfaces lie.   published_plans.md (M2)
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "partition/plan.h"

namespace lightfit {

struct ViewGridPoint {
  Eigen::Vector3d position;  // world
  double scale = 0.0;        // pixels of a texel are scale q^3
};

// Valid input. Empty when nothing is in view, or it is smaller than the grid's cells.
std::vector<ViewGridPoint> ViewGrid(const MethodInput& input);

// Over the grid; infinite when no map may be asked at some point of it. 0 for an empty grid.
double MeanTexelSide(const PlanLookUp& look_up, const std::vector<ViewGridPoint>& grid);

}  // namespace lightfit
