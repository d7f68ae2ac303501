// partition/tracking/keep_plan.h
//
// What can be kept of the plan of the frame before, map by map.
// In:   the maps as they were; one frame's LightView and ServedRays.
// Out:  maps that hold all that must be held, at little cost: kept, moved by whole texels, or new.
//       docs/mathematics.md 11, (23)
//
// Of all ways to hold what must be held the one is taken that costs least
// (partition/tracking/frame_costs.h).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/scratch.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "partition/pixel_rays.h"
#include "partition/plan_options.h"
#include "partition/served_rays.h"
#include "partition/tracking/frame_costs.h"
#include "partition/tracking/held_bins.h"
#include "partition/tracking/kept_map.h"

namespace lightfit {

// In one frame. Of no use once a StopScope says so.
class PlanKeeper {
 public:
  // All of it but `before` must outlive the keeper. `before`: the maps of the frame before.
  // `roomy`: how maps are fitted anew.
  PlanKeeper(const LightView& view,
             const ServedRays& rays,
             const KeptMaps& before,
             const PlanOptions& options,
             const FitOptions& roomy);

  HeldBins HeldBy(const KeptMaps& maps) const;

  // Moves maps and fits them anew, at the least cost, so that together they hold all: HeldBy() of
  // the maps as they are then. Nothing, and the maps as they were, where there is no way.
  std::optional<HeldBins> HoldAll(KeptMaps* maps) const;

  // The energy if every map were fitted anew to what asks it, as tightly as may be, where that is
  // better than what is there. `held` is HeldBy(maps).
  double TightEnergyOf(const KeptMaps& maps, const HeldBins& held) const;

  // Fits maps anew, each to what asks it, so that the energy is below `most` at the least price.
  // The price; infinite, and the maps as they were, where there is no way.
  double LowerEnergy(double most, KeptMaps* maps) const;

  // Fits every map anew to what asks it, with room.
  void MakeRoomy(KeptMaps* maps) const;

  const FrameCosts& costs() const { return costs_; }

 private:
  // Beginning from a map, one of the same size that holds these bins; nothing where there is none.
  std::optional<KeptMap> FittedTo(const HeldBins& held,
                                  const ScratchVector<int>& bins,
                                  const KeptMap& start,
                                  MapSize size,
                                  const FitOptions& fit,
                                  TrackerAction action) const;

  // Lets one map hold bins that no map holds. Whether one can.
  bool HoldByOne(const ScratchVector<int>& outside, const HeldBins& held, KeptMaps* maps) const;
  std::optional<HeldBins> HoldStepByStep(bool by_groups, HeldBins held, KeptMaps* maps) const;

  const LightView& view_;
  const ServedRays& rays_;
  const PlanOptions& options_;
  const FitOptions& roomy_;
  PixelRays pixels_;
  FrameCosts costs_;
};

}  // namespace lightfit
