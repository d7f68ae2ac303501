// partition/published/face_partition.h
//
// Maps for the faces of the view frustum, each warped along its face.
// In:      MethodInput, whose map is the budget: all maps together have at most its texels; how
//          many parts each side face has, and whether they are warped.
// Out:     Plan: a map for each cell of face_cells.h.
// Symbols: e0, e1 the view's edges beside a face, e0', e1' as the light sees them from the eye.
//
// Lloyd et al. 2006, 5.1: a light along the view sees a square, on which no warp helps; its side
// faces are trapezoids, on which one does ("FP+W", with several parts "FP+ZP+W"). A face's warp has
// its axis along the bisector of e0' and e1', both of unit length: with their sum as it stands, a
// face that is nearly edge-on would take hundreds of times the texels. It is as strong as makes the
// largest error along the axis the least (least_error_warp.h), as for light-space perspective maps.
//
// Edge cases: an orthographic view, whose pixels do not shrink with depth, and a view of which
// nothing is seen have one focused map. A cell without receivers in view has no map.
#pragma once

#include "absl/status/statusor.h"
#include "methods/method.h"
#include "partition/plan.h"
#include "partition/published/plan_parts.h"

namespace lightfit {

struct FacePartitionOptions {
  int num_parts = 1;           // of each side face, at equal ratios of depth
  bool warp = true;            // otherwise each cell has its focused map
  bool has_near_face = false;  // a map of its own; otherwise the sides are stretched over it
  PlanShapes shapes = PlanShapes::kByStorage;  // the cells differ in size
  double margin_texels = 0.0;  // around what a map serves, what PlanLookUp guards; >= 0
};

// InvalidArgument: input or options are wrong, or there are more than kMaxPlanMaps cells.
// FailedPrecondition: a cell has no map, a point light hangs among its receivers.
absl::StatusOr<Plan> FacePartition(const MethodInput& input,
                                   const FacePartitionOptions& options = {});

}  // namespace lightfit
