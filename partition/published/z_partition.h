// partition/published/z_partition.h
//
// Maps for slices of the view's depth: cascaded and parallel-split shadow maps.
// In:      MethodInput, whose map is the budget: all maps together have at most its texels; how
//          many maps, where to split, which set-up serves each of them.
// Out:     Plan: per slice the map that the set-up makes for the camera with the slice's near and
//          far planes, and the half spaces of the slice.
//
// Lloyd et al. 2006, 5.2: splits at equal ratios (15, 16) make all slices similar, and their
// largest error and the sum of their storage factors the least; with a warp in each this is "ZP+W".
// Zhang, Sun, Xu & Lun 2006 (parallel-split shadow maps) mix them with splits at equal distances.
//
// A slice in which the camera sees no receiver has no map, and its texels go to the others; when it
// sees none at all there is one map of all receivers. Nothing bounds the first slice at the near
// and the last at the far end, so that rounding leaves no receiver without a map.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "partition/plan.h"
#include "partition/published/plan_parts.h"

namespace lightfit {

struct ZPartitionOptions {
  int num_maps = 4;        // 1 ... kMaxPlanMaps
  double log_share = 1.0;  // 1: equal ratios; 0: equal distances; their mix between (Zhang: 0.5)
  Method method = Method::kLispsm;
  PlanShapes shapes = PlanShapes::kEqualSquares;
  double margin_texels = 0.0;  // around what a map serves, what PlanLookUp guards; >= 0
};

// num_parts + 1 depths, rising from near to far.
std::vector<double> DepthSplits(double near, double far, int num_parts, double log_share);

// InvalidArgument: input or options are wrong. FailedPrecondition: a slice has no map, a point
// light hangs among its receivers.
absl::StatusOr<Plan> ZPartition(const MethodInput& input, const ZPartitionOptions& options = {});

}  // namespace lightfit
