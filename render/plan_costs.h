// render/plan_costs.h
//
// What a plan costs besides its texels: maps that hold the same receivers, and casters that are
// drawn more than once.
// In:   a RayCaster, what the camera sees, the true lighting, a light and its Plan.
// Out:  PlanCosts: counts for each map, overlap, draws per caster.
//
// A map draws the triangles that reach into its frustum, the rays in its rectangle from the light
// on; its half spaces are about receivers, and cut no casters, as a caster may lie anywhere on a
// receiver's ray. Nor does depth: casters nearer than the near plane are clamped to it, and row 3
// of the matrix does not matter. The frustum's planes are linear in the homogeneous world point,
//   u w >= 0,  W w - u w >= 0,  v w >= 0,  H w - v w >= 0,  w > 0,
// so that triangles with vertices behind the light need no clipping. As renderers do, a triangle is
// left out when all its vertices are outside of one of them: none is missed, and a few near the
// frustum's edges that miss it count as well.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "partition/plan.h"
#include "render/ray_caster.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

struct MapCosts {
  int64_t receivers = 0;  // judged pixels that the map may be asked about
  int64_t asked = 0;      // of them: that ask it
  int64_t casters = 0;    // triangles that it draws
};

struct PlanCosts {
  std::vector<MapCosts> maps;
  int64_t receivers = 0;  // judged pixels: those that face the light
  int64_t casters = 0;    // triangles that any map draws

  double overlap = 0.0;           // how many maps may be asked about a judged pixel, mean
  double draws_per_caster = 0.0;  // how many maps draw a triangle that any map draws, mean
};

// InvalidArgument for a truth of another image, and for a plan that PlanLookUp refuses.
absl::StatusOr<PlanCosts> MeasurePlanCosts(const RayCaster& caster,
                                           const SurfaceImage& image,
                                           absl::Span<const Lighting> truth,
                                           const Light& light,
                                           const Plan& plan);

}  // namespace lightfit
