// bench/plan_rows.h
//
// Several maps for one light in every way there is: the rows of bench_plans.
// In:   what the camera sees and the light; read-backs of two sizes.
// Out:  PlanRow: a name, and how its plan of at most kPlanTexels is made.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "methods/method.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"

namespace lightfit {

inline constexpr MapSize kPlanMap = {400, 400};
inline constexpr int64_t kPlanTexels = int64_t{kPlanMap.width} * kPlanMap.height;

struct PlanInputs {
  const MethodInput& method;
  const Surfaces& small;
  const Surfaces& large;
  const Light& light;
};

struct PlanRow {
  enum class Kind { kOneMap, kPublished, kOurs };
  using Make = std::function<absl::StatusOr<Plan>(const PlanInputs&)>;

  std::string name;
  Kind kind = Kind::kOneMap;
  bool from_large = false;  // the read-back that it is fitted from
  std::vector<Make> make;   // of several the one with the fewest wrong pixels on each light
};

// The rows that others are compared with.
inline constexpr size_t kOneMap = 0, kOneChosen = 1, kAsPublishedMap = 2, kZp4 = 3;

// `num_maps` of ours, from read-backs of both sizes.
std::vector<PlanRow> MakePlanRows(const std::vector<int>& num_maps, int small_side, int large_side);

}  // namespace lightfit
