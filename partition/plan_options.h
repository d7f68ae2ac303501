// partition/plan_options.h
//
// Every choice of a plan: how many maps, of which sizes, and how each of them is fitted.
#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

struct PlanOptions {
  // Of which samples, cover, border, metric, margin and min_w count. Maps are enclosing
  // parallelograms of least energy in any case.
  FitOptions fit;

  // 1 ... kMaxPlanMaps. A plan may have fewer; of fewer than fit.samples.min_samples samples it is
  // the focused map, where there is one.
  int max_maps = 4;

  // Whether plans of fewer maps, one included, are tried too and the one taken of which the fewest
  // wrong pixels are foretold (ForetellWrongShare()), more maps only for 5 % less; with
  // BorderChoice::kAutomatic in either border, and with and without the finer cover. Else the plan
  // of `max_maps` is taken as it is, in less time: docs/plans.md says how much. Without the third
  // state (Readback::facing_bits) forecasts rank plans too badly, and it is taken in any case.
  bool choose_by_forecast = true;

  // Of all maps together; never exceeded.
  int64_t texels = int64_t{1} << 20;

  // All maps have this size, and `texels` does not count: for arrays of equal textures.
  std::optional<MapSize> each;

  // The sizes that maps may have, `texels` in all: those of least energy are chosen. Not with
  // `each`. Takes memory from the heap.
  std::optional<MapSizeRules> sizes;

  // The outermost texels of every map that look-ups keep away from, half a filter's width: what the
  // maps must serve lies within. >= 0.
  double guard_texels = 0.0;
};

// The most texels that a plan may have: those of the largest single map.
inline constexpr int64_t kMostPlanTexels = int64_t{kMaxMapSide} * kMaxMapSide;

// The fewest that one of so many maps may have.
inline int64_t LeastPlanTexels(int max_maps) { return int64_t{64} * max_maps; }

// The same of plans with `sizes`, which must be valid.
int64_t LeastPlanTexels(const PlanOptions& options);

// InvalidArgument names the field as options.FIELD.
absl::Status ValidatePlanOptions(const PlanOptions& options);

}  // namespace lightfit
