// partition/served_rays.h
//
// What the maps of a plan are fitted to, sorted into bins of rays that lie close together.
// In:   a LightView (one light in one read-back, and the border).
// Out:  ServedRays: bins, each with the rays that must be covered and its samples.
//
// A cell of a plan is a set of bins, so that what is known of a bin (sums, hulls) is added up and
// not found anew for every cell that is tried.
//
// Between two pixels of a read-back lie several of the image. One map's margin hides that, several
// small ones would leave dark strips between them: so not the rays of pixels' centres are covered
// but those of their corners, each on the pixel's own plane. On a plane they tile the screen.
//
// Cells of the finer cover (Readback::fine_cover) have bins of their own, of rays to be covered and
// nothing else: no samples, and no pixels. Those that a bin of pixels holds already are left out.
//
// Every covered pixel also counts as a sample of its whole footprint, all of them together a tenth
// of the boundary's: a cell with few boundary samples would be fitted to those few, and the rest of
// it would get texels as large as rooms.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/homography.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/fine_surfaces.h"

namespace lightfit {

// One sample in the form that sums and footprints are made from: weight, ray, and the metric's
// tensor in it, (D'n)(D'n)' and D'D as MetricWeights have it.
struct RaySample {
  Eigen::Vector3d X;
  SymmetricVector G;
  double weight = 1.0;
  bool is_boundary = true;  // else a covered pixel
};

// Of nothing: what widens it is what it has.
inline constexpr DepthRange kNoDepth = {std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};

struct RayBin {
  Eigen::Vector3d middle;  // mean of the unit rays to what is in it
  // The extreme of the rays to cover, of whatever length; none where the bin has samples only. Rays
  // and no pixels: of the finer cover.
  ScratchVector<Eigen::Vector3d> hull;
  int samples_begin = 0, samples_end = 0;  // in ServedRays::samples
  int pixels_begin = 0, pixels_end = 0;    // the covered ones, in ServedRays::pixels
  int num_covered = 0;                     // pixels
  DepthRange distance = kNoDepth;          // of what is covered, from a point light; world units
};

struct ServedRays {
  // All rays X' = N X of light-space rays X (RayFromWorld()); the identity where receivers surround
  // the light.
  Eigen::Matrix3d normalized_from_ray = Eigen::Matrix3d::Identity();

  // Whether one map could cover all: then X'_3 > 0 on every ray.
  bool has_single_cover = false;

  ScratchVector<RayBin> bins;
  ScratchVector<RaySample> samples;       // by bin
  ScratchVector<Eigen::Vector2i> pixels;  // to cover, by bin: column and row
  int num_boundary = 0;                   // of them at shadow edges; the others are covered pixels
  int64_t num_covered = 0;                // pixels
  // Of all receivers, and of the finer cover: from a point light, or along the direction of travel.
  DepthRange distance;
};

struct ServedRaysOptions {
  // How far from a pixel's centre its corners are, in pixels of the read-back. >= 0.
  double corner = 0.5;
  // Weight of all covered pixels together, as a share of that of the boundary samples. >= 0.
  double floor_share = 0.1;
  // The most bins there are, and the most beside them for the finer cover. >= 1.
  int max_bins = 1024;
  int max_fine_bins = 256;
};

// The extreme ones of rays that lie close together: all others are between them. `middle` is among
// them or near.
ScratchVector<Eigen::Vector3d> ExtremeRays(const ScratchVector<Eigen::Vector3d>& rays,
                                           const Eigen::Vector3d& middle);

// What the finer cover adds to what the maps must have room for: as of one map (CoverReceivers()),
// and also where that leaves it out, as it is all around a point light. None without
// FitOptions::use_fine_cover.
ScratchVector<FineSurfaces> FineSurfacesServed(const LightView& view, const FitOptions& fit);

// Of `fit` count the cover, finer or not, and the metric; the view was made with it. CancelledError
// once a StopScope says so.
absl::StatusOr<ServedRays> FindServedRays(const LightView& view,
                                          const FitOptions& fit,
                                          const ServedRaysOptions& options = {});

}  // namespace lightfit
