// partition/tracking/held_bins.h
//
// Which of the maps that are there hold what is to be covered.
// In:   ServedRays, the rays of its pixels; maps of the same rays.
// Out:  HeldBins: bins of which each is held by a map as a whole, or not at all.
//
// A bin that reaches over the side of every map is taken apart: each of its pixels goes to the map
// that holds the pixel's corners. Maps hold a pixel or do not, there is no strip between two of
// them that goes through it.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/types/span.h"
#include "base/scratch.h"
#include "geometry/ray_maps.h"
#include "partition/pixel_rays.h"
#include "partition/served_rays.h"

namespace lightfit {

// What rounding may put outside of a map, texels.
inline constexpr double kHeldTolerance = 1e-6;

struct HeldBins {
  ServedRays rays;

  // Of each bin: a bit for every map that holds all of it, and the densest of those, -1 where there
  // is none. A bin without anything to cover is held by the maps that hold its middle.
  ScratchVector<uint32_t> held_by;
  ScratchVector<int> asked;

  // The bins that ask map k; that it holds; that no other map holds; and those that are to be held
  // and that no map does.
  ScratchVector<int> BinsOf(int k) const;
  ScratchVector<int> BinsIn(int k) const;
  ScratchVector<int> BinsOnlyIn(int k) const;
  ScratchVector<int> BinsOutside() const;

  bool HoldsAll() const;
};

// At most kMaxPlanMaps maps, of whose outermost `guard_texels` nothing may lie in. `corner` as in
// ServedRaysOptions.
HeldBins FindHeldBins(const ServedRays& rays,
                      const PixelRays& pixels,
                      absl::Span<const RayMap> maps,
                      double guard_texels,
                      double corner = ServedRaysOptions().corner);

}  // namespace lightfit
