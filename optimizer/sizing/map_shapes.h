// optimizer/sizing/map_shapes.h
//
// What a light's map costs at any size: a few fits foretell all of them.
// In:   a Summary, its Light, FitOptions.
// Out:  MapShapes: energy of a map of width x height, the best aspect, the law of scaling.
//
// A map with fixed axis and edges e1, e2 that is cut into width x height texels has the energy
//
//   E = A / width^2 + B / height^2 ,   A = e1' M e1 ,  B = e2' M e2                     math.md (9)
//
// so that at S texels the best aspect is width / height = sqrt(A / B), with E = 2 sqrt(A B) / S.
// math.md (15). Axis and edges that were fitted at one aspect are not the best at another. But
// whatever was fitted once can be had at every size: the least of the energies above over all known
// shapes is an upper bound of the best energy, and meets it at each fitted aspect. The shapes come
// from fits at aspects half an octave apart, up to 16 : 1, and then from alternating: take the best
// aspect for the edges, fit anew, until it stands still. Neither step raises the energy.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/readback.h"
#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

// A and B above: squared footprints at one texel each way, margins of FitOptions::margin_texels
// apart.
struct MapShape {
  double along_u = 0.0;
  double along_v = 0.0;
};

struct MapShapes {
  std::vector<MapShape> shapes;  // not empty; each with along_u >= along_v
  double margin_texels = 0.0;    // FitOptions::margin_texels
  double footprint_sum = 0.0;    // Summary::footprint_sum: 0, or energies are sqrt(E footprint_sum)

  // An upper bound of what Fit() reaches at this size, in the metric of the summary. Width and
  // height may be exchanged. Infinity where the margins leave no map.
  double Energy(double width, double height) const;

  // width / height >= 1 of the best map, margins apart; 64 at most.
  double BestAspect() const;

  // A map of that aspect, large enough that whole texels do not matter.
  MapSize BestMap() const;

  // The best map of S texels has the energy UnitEnergy() S^-Exponent(), margins apart: 1 for sums
  // of squares, 1/2 for sums of footprints.   math.md (15)
  double UnitEnergy() const;
  double Exponent() const { return footprint_sum > 0.0 ? 0.5 : 1.0; }
};

// Errors are those of Fit(); FailedPrecondition also where the energy is 0 at any size.
absl::StatusOr<MapShapes> FindMapShapes(const Summary& summary,
                                        const Light& light,
                                        const FitOptions& options);

// The sizes that keep the rules and are worth their texels, each with MapShapes::Energy times
// `weight` as its cost.
std::vector<RatedSize> RateSizes(const MapShapes& shapes, double weight, const MapSizeRules& rules);

// Summarize() with maps of any aspect in mind: for the L1 metrics the samples weigh what they do in
// the light's best map of all aspects, found by weighing and fitting in turn, where Summarize()
// takes the best square one. Neither step raises UnitEnergy(). For the other metrics the same.
absl::StatusOr<Summary> SummarizeForAnyAspect(const LightView& view, const FitOptions& options);
absl::StatusOr<Summary> SummarizeForAnyAspect(const Readback& readback,
                                              const Light& light,
                                              const FitOptions& options);

}  // namespace lightfit
