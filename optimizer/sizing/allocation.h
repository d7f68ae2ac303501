// optimizer/sizing/allocation.h
//
// A budget of texels, split over the shadow maps of several lights.
// In:   a Summary for each light (or partition of a light), weights, a number of texels, the sizes
//       that hardware takes.
// Out:  Allocation: a size and a matrix for each; least weighted energy, budget kept.
//
// A light's best energy falls with its texels S as k S^-q: q = 1 for sums of squared footprints,
// 1/2 for sums of footprints. With weights c the sum of the energies is least at
//
//   S_l proportional to (c_l k_l)^(1 / (1 + q))                                        math.md (16)
//
// Whole sizes are then chosen anew, as rounding that split can lose much, with powers of two above
// all: light by light, the cheapest way to spend each number of texels on the lights so far
// (dynamic programming over the budget). That is exact while the budget holds at most 8192 steps,
// which is 5792x5792 texels in multiples of 64; beyond that, two ways that differ by less than a
// step count as one. All sizes are rated by their light's MapShapes; those chosen are fitted.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

struct AllocationLight {
  Light light;

  // SummarizeForAnyAspect() (optimizer/sizing/map_shapes.h) or Summarize(), with the allocation's
  // options.
  absl::StatusOr<Summary> summary = absl::UnknownError("not summed up");

  double weight = 1.0;  // what its energy counts in the total; > 0
};

struct AllocatedMap {
  // The matrix, whose `map` is the size given; or why this light has none, and gets no texels.
  absl::StatusOr<LightMatrix> matrix = absl::UnknownError("not fitted");

  double ideal_texels = 0.0;  // by math.md (16), before rounding
  double ideal_energy = 0.0;  // a bound of what they would bring
};

struct Allocation {
  std::vector<AllocatedMap> maps;  // in the order of the lights
  int64_t texels = 0;              // of all maps together; never above the budget
  double energy = 0.0;             // sum of weight times energy
  double ideal_energy = 0.0;       // the same before rounding
};

// The budget is the texels of all maps together; each map is a texture of its own. A light without
// a matrix has its own status and leaves its texels to the others.
// InvalidArgument for weights, rules or options that cannot be used, for summaries of different
// metrics, and for a budget below the smallest maps of all lights. CancelledError, for all of it,
// once a StopScope says so.
absl::StatusOr<Allocation> AllocateBudget(absl::Span<const AllocationLight> lights,
                                          int64_t budget_texels,
                                          const MapSizeRules& rules,
                                          const FitOptions& options = {});

// The stations of it. What they return once a StopScope says so is valid, but nothing like the
// best.

// S_l within [least, most] that sum to `budget`, or to less where all are at their most.
// math.md (16). `factors` are c_l k_l.
struct TexelLimits {
  double least = 0.0;
  double most = 0.0;
};
std::vector<double> SplitTexels(absl::Span<const double> factors,
                                double exponent,
                                double budget_texels,
                                const TexelLimits& limits);

// Which of each light's sizes to take: their texels sum to at most `budget_texels`, their costs to
// as little as can be. `sizes` are as RateSizes() returns them. The smallest sizes must fit.
std::vector<size_t> ChooseSizes(absl::Span<const std::vector<RatedSize>> sizes,
                                int64_t budget_texels);

}  // namespace lightfit
