// partition/published/light_partition.h
//
// Light-space partitioned shadow maps: the view as the light sees it, cut into rectangles.
// In:   MethodInput, whose map is the budget: all maps together have at most its texels.
// Out:  a Plan of equal square maps without a warp, or what leads to it.
//
// Tang, Luo, Ni, Duan & Gao 2017 (IEICE Transactions). The part of the receivers that is in view is
// enclosed in an isosceles trapezoid across the light, its axis along the view; this is cut into
// rows, and rows into columns (trapezoid_rows.h). How many there are depends on the light and the
// view. Each cell is a map. Every receiver falls into one, as cells end at planes through the
// light.
//
// A point light's plane is the image plane of the methods (methods/light_body.h); the paper has
// directional lights alone. A light along the view: a rectangle, as in the paper, which leaves its
// direction open; here it is the least one, and rows run across its longer side. Nothing in view:
// all receivers take its place. A base of less than a thousandth of the far one is made as wide as
// that, as rows begin with its size.
//
// Errors: as of the methods, FailedPrecondition for a point light among what is in view.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "methods/light_body.h"
#include "methods/method.h"
#include "partition/plan.h"
#include "partition/published/trapezoid.h"
#include "partition/published/trapezoid_rows.h"

namespace lightfit {

struct LightPartitionOptions {
  RowOptions rows;
  // Around each cell: what PlanLookUp guards. >= 0.
  double margin_texels = 0.0;
};

struct LightPartition {
  LightBody body;
  // Of a ray X: a = across.X / X_3 and b = along.X / X_3.
  Eigen::RowVector3d across, along;
  Trapezoid trapezoid;
  std::vector<TrapezoidRow> rows;
  bool is_along_view = false;  // the light, so that the trapezoid is a rectangle

  int num_maps() const { return NumCells(rows); }
};

absl::StatusOr<LightPartition> PartitionLight(const MethodInput& input,
                                              const RowOptions& options = {});

absl::StatusOr<Plan> LightPartitionPlan(const MethodInput& input,
                                        const LightPartitionOptions& options = {});

}  // namespace lightfit
