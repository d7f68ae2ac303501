// partition/shipped/sample_distribution.h : sample distribution shadow maps.
//
// In:   what a read-back sees, a light, texels of all maps.
// Out:  a Plan of equal squares, one for each part of the depths that are seen.
//
// Lauritzen, Salvi & Lefohn 2010: the view is split where its surfaces are, logarithmically between
// the nearest and the furthest depth actually seen, and a part's map is the box, in the light's
// frame, around the receivers that were seen in it.   docs/published_plans.md
//
// A box holds the corners of its receivers' pixels (receiver_pixels.h), as a read-back is coarser
// than the depth buffer that the paper goes through.
//
// Edge cases: a part without receivers, or with nothing that the light sees as an area, has no map:
// its depths go to the part before it and its texels to all. An orthographic view is split
// uniformly. Of a point light, which the paper leaves out, the box lies in the image plane across
// the middle of the part's rays.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"

namespace lightfit {

struct SampleDistributionOptions {
  int num_maps = 4;  // at most; 1 ... kMaxPlanMaps

  // The rectangle of least area, and not the box along the axes of the light's frame, as published.
  bool min_area_rotation = false;
};

// InvalidArgument for a light or option out of range, and when the budget leaves no texel.
// FailedPrecondition when all receivers lie in one plane with the light, or those of a part
// surround a point light; CancelledError once a StopScope says so.
absl::StatusOr<Plan> SampleDistributionMaps(const Surfaces& surfaces,
                                            const Light& light,
                                            int64_t max_texels,
                                            const SampleDistributionOptions& options = {});

}  // namespace lightfit
