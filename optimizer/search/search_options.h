// optimizer/search/search_options.h
//
// Every choice of the search for a map, in the words of docs/mathematics.md.
#pragma once

#include "absl/status/status.h"
#include "optimizer/energy/metric.h"

namespace lightfit {

// How the axis (the projective part of the matrix) is found.
enum class Search {
  kFocused,                    // the receivers' mean, no search: the usual focused shadow map
  kRotationLineSearch,         // Chong & Gortler, Algorithm 1
  kRotationLineSearchRefined,  // ... then Ceres and a polish
  kGlobal  // grid over the polar polygon, then Ceres and a polish from the best of it
};

// How the map's rectangle is laid around the rays once the axis is known.
enum class Affine {
  kMinAreaRectangle,       // Chong & Gortler: the enclosing rectangle of least area
  kMinAreaRectangleCgal,   // the same from CGAL; UNIMPLEMENTED in builds without it
  kSkewedRectangle,        // ... with their shear heuristic (Fig. 3 there)
  kMinEnergyParallelogram  // the enclosing parallelogram of least energy: math.md 5
};

// Which solver refines the axis. Both minimise the same cost, optimizer/search/refine.h.
enum class Refiner {
  kTinySolver,  // ceres::TinySolver: microseconds, no allocation; for the frame loop
  kCeres        // ceres::Solve, whose report goes to LightMatrix::solver_report
};

// In which coordinates of the rays the axis is rotated.
enum class RaySpace {
  kLightSpace,  // as published: orthonormal axes at the light
  kNormalized   // the enclosing rectangle of the rays is a square of side 2: math.md 1
};

struct SearchOptions {
  Metric metric = Metric::kL1AcrossEdge;
  Search search = Search::kGlobal;
  Affine affine = Affine::kMinEnergyParallelogram;
  RaySpace ray_space = RaySpace::kNormalized;
  Refiner refiner = Refiner::kTinySolver;

  // The read-back is coarse, so the enclosing shape is grown on every side by this share of its
  // extent, in percent, and by this many texels. >= 0.
  double margin_percent = 1.0;
  double margin_texels = 0.0;

  // The smallest w = p.X of a ray, as a share of w at the middle of the rays. It keeps the warp,
  // and with it the depth precision, finite. In (0, 1).
  double min_w = 1e-3;

  // kL2AcrossEdge, kL1AcrossEdge: share of the whole footprint added to that across the edge.
  // (0, 1].
  double along_edge_share = 0.05;

  // kL1, kL1AcrossEdge: rounds of reweighting. >= 1.
  int reweighting_rounds = 5;

  // Rounds of the rotation line search ("k" in the paper). >= 1.
  int line_search_rounds = 3;

  // kGlobal: directions in which candidates are spread over the polar polygon. >= 3.
  int grid_directions = 12;

  // Evaluate every candidate sample by sample, receiver by receiver, as the paper does, instead of
  // from the summary: the yardstick for speed. The result is the same to rounding.
  bool sample_by_sample = false;
};

// InvalidArgument names the field as options.FIELD.
absl::Status ValidateSearchOptions(const SearchOptions& options);

}  // namespace lightfit
