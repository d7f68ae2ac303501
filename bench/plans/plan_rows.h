// bench/plans/plan_rows.h
//
// Several maps for one light in every way there is: the rows of bench_plans.
// In:   how many maps ours may have; read-backs of two sizes.
// Out:  PlanRow: a name, and the schemes (jobs/schemes) that it stands for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "jobs/schemes/scheme.h"

namespace lightfit {

inline constexpr MapSize kPlanMap = {400, 400};
inline constexpr int64_t kPlanTexels = int64_t{kPlanMap.width} * kPlanMap.height;

struct PlanRow {
  enum class Kind { kOneMap, kPublished, kOurs, kMoreTexels };

  std::string name;
  Kind kind = Kind::kOneMap;
  bool from_large = false;       // the read-back that it is fitted from
  std::vector<Scheme> schemes;   // of several the one with the fewest wrong pixels on each light
  int64_t texels = kPlanTexels;  // at most, of all maps
};

// The rows that others are compared with.
inline constexpr size_t kOneMap = 0, kOneChosen = 1, kAsPublishedMap = 2, kZp4 = 3;

// `num_maps` of ours, from read-backs of both sizes.
std::vector<PlanRow> MakePlanRows(const std::vector<int>& num_maps, int small_side, int large_side);

}  // namespace lightfit
