// optimizer/fit_options.h
//
// Every choice of the fit, in the words of docs/mathematics.md. Plain structs; all have defaults.
#pragma once

#include <stop_token>

#include "absl/status/status.h"

namespace lightfit {

// Which pixels of the read-back count, and how much.
struct SampleOptions {
  // A pixel is rejected as lying on a depth discontinuity when the second difference of affine
  // depth exceeds this share of the larger first difference, along x or y. In (0, 1].
  // Chong & Gortler 2.4 threshold the "acceleration in z"; no number is given there.
  double max_depth_bend = 0.5;

  // ... unless the second difference is below this share of the depth itself: a surface facing the
  // camera has first differences near zero, where their ratio is only rounding noise. >= 0.
  double depth_noise = 1e-5;

  // Whether pixels at a depth discontinuity count as well: shadow edges run along outlines, and on
  // thin things there is nothing else. Their derivative is that of the side that continues.
  bool use_outlines = true;

  // Whether a shadow's border with surfaces that are turned away from the light counts as an edge.
  // Nothing is lit on either side of it.
  bool use_terminators = false;

  // Surfaces closer to edge-on than this are rejected: cosine between the surface normal and the
  // direction to the light, or to the eye. In [0, 1). Under a low sun the whole floor is nearly
  // edge-on to the light, and where its shadows lie.
  double min_cos_light = 0.002;
  double min_cos_eye = 0.01;

  // Fewer boundary samples than this are not fitted: the optimum would serve one corner of one
  // shadow. >= 1.
  int min_samples = 8;

  // Half width of the window, in pixels, over which the direction of a shadow edge is estimated
  // (the metrics across the edge only). 1 ... 8.
  int edge_window = 2;
};

// What is summed over the samples.
enum class Metric {
  kL2,            // squared footprint of a texel: math.md (3), Chong & Gortler (6)
  kL2AcrossEdge,  // squared extent across the shadow's edge, plus a little of kL2: math.md 4
  kL1,            // footprint, by iteratively reweighted kL2
  kL1AcrossEdge   // extent across the shadow's edge, by iteratively reweighted kL2AcrossEdge
};

bool IsL1(Metric metric);

// What the map must have room for.
enum class Cover {
  kReceivers,  // every surface in view: nothing that comes to be shadowed is outside
  kShadowed  // every shadowed surface in view: what is lit may lie outside the map, where a look-up
             // finds light. Every surface where the shadow has no area
};

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

// Which solver refines the axis. Both minimise the same cost, optimizer/refine.h.
enum class Refiner {
  kTinySolver,  // ceres::TinySolver: microseconds, no allocation; for the frame loop
  kCeres        // ceres::Solve, whose report goes to LightMatrix::solver_report
};

// In which coordinates of the rays the axis is rotated.
enum class RaySpace {
  kLightSpace,  // as published: orthonormal axes at the light
  kNormalized   // the enclosing rectangle of the rays is a square of side 2: math.md 1
};

struct FitOptions {
  SampleOptions samples;
  Metric metric = Metric::kL1AcrossEdge;
  Cover cover = Cover::kShadowed;
  Search search = Search::kGlobal;
  Affine affine = Affine::kMinEnergyParallelogram;
  RaySpace ray_space = RaySpace::kNormalized;
  Refiner refiner = Refiner::kTinySolver;

  // The defaults are those that leave the fewest wrong shadow pixels: docs/defaults.md.

  // The read-back is coarse, so the enclosing shape is grown on every side by this share of its
  // extent, in percent, and by this many texels. >= 0.
  double margin_percent = 1.0;
  double margin_texels = 0.0;

  // The smallest w = p.X of a ray, as a share of w at the middle of the rays. It keeps the warp,
  // and with it the depth precision, finite. In (0, 1).
  double min_w = 1e-3;

  // kL2AcrossEdge, kL1AcrossEdge: share of the whole footprint added to that across the edge. (0,
  // 1].
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

  // Worst footprint and percentiles take one more pass over the samples.
  bool compute_statistics = true;

  // When it says stop, from whatever thread, what is under way with these options ends with
  // CancelledError, within a fraction of a millisecond of search or a few rows of pixels. No choice
  // of the fit: what comes to its end is the same with and without. The default never stops.
  std::stop_token stop;

  // Chong & Gortler's Algorithm 1 to the letter: squared footprints, all receivers covered, light
  // space, minimum-area rectangle, three rounds; no samples at depth discontinuities.
  static FitOptions AsPublished();
};

absl::Status ValidateFitOptions(const FitOptions& options);

}  // namespace lightfit
