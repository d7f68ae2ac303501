// partition/tracking/frame_costs.h
//
// What maps cost in one frame: their energy, and what of it is redrawn.
// In:   the frame's LightView and ServedRays, the maps of the frame before; maps.
// Out:  sums of footprints.
//
// Redrawn is what is looked up in other texels than in the frame before: in a map that was fitted
// anew, or in another map. What crawls is then of the size of its footprints, and as crawl is a
// root mean square, so is this: over all samples, times their number, to be a sum as the energy is.
//   math.md (23)
#pragma once

#include "base/scratch.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "partition/cell_fit.h"
#include "partition/served_rays.h"
#include "partition/tracking/kept_map.h"

namespace lightfit {

// Of no use once a StopScope says so.
class FrameCosts {
 public:
  // `rays` must outlive the object. Of `fit` counts the metric; maps are asked as look-ups ask
  // them, `guard_texels` from their sides.
  FrameCosts(const LightView& view,
             const ServedRays& rays,
             const KeptMaps& before,
             const FitOptions& fit,
             double guard_texels);

  // Sum over the boundary samples in the metric, as LightPlan::energy; those of each map.
  double EnergyOf(const KeptMaps& maps) const;
  ScratchVector<double> EnergiesOf(const KeptMaps& maps) const;

  // The same with each map in the place of that which is asked, whether or not it holds the
  // samples.
  ScratchVector<double> EnergiesInstead(const KeptMaps& asked, const KeptMaps& instead) const;

  // Energy and what is redrawn, the covered pixels among the samples.
  double CostOf(const KeptMaps& maps) const;

  // What is redrawn per energy that is left to `most`: for about how long it will do. Infinite
  // where none is left.
  double PriceOf(const KeptMaps& maps, double most) const;

 private:
  struct Costs {
    double energy, redrawn;
  };
  Costs CostsOf(const KeptMaps& maps) const;
  double FootprintOf(const RaySample& sample, const MapExtents& extents) const;

  const ServedRays& rays_;
  ScratchVector<RayMap> before_;
  ScratchVector<RaySample> boundary_;
  bool is_l1_;
  double guard_texels_;
};

}  // namespace lightfit
