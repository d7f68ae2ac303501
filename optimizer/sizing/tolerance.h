// optimizer/sizing/tolerance.h
//
// The smallest shadow map that keeps its texels as small on the screen as was asked for.
// In:   Readback, Light, a Tolerance in pixels of the final image, the sizes that hardware takes.
// Out:  ToleranceMap: the matrix, what it reaches, and for how many samples that is promised.
//
// Sizes worth their texels (RateSizes()) are tried in halving steps: each is fitted, and its
// footprint measured sample by sample (Footprint(), math.md (2)) on the final matrix. What is
// returned has been measured to hold; the next smaller size tried has been measured not to.
//
// The fit minimises the tolerance's own figure: squared footprints for the root mean square; for
// the others squares reweighted towards the samples that decide (Lawson 1961).   math.md (17)
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/readback.h"
#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

// Of the footprints sqrt((|dS/du|^2 + |dS/dv|^2) / 2) at the samples.
struct Tolerance {
  enum class Kind {
    kRms,   // root mean square
    kP99,   // at least 99 % of the samples are at or below it
    kWorst  // all are
  };

  Kind kind = Kind::kRms;
  double limit_px = 1.0;  // pixels of the final image per texel, > 0

  // Pixels of the final image per pixel of the read-back. > 0.
  double image_scale = 1.0;
};

absl::Status ValidateTolerance(const Tolerance& tolerance);

struct ToleranceMap {
  // FitOptions::compute_statistics gives its footprint, in read-back pixels as always.
  LightMatrix matrix;

  bool is_met = false;      // else `matrix` is the best that the largest maps give
  double reached_px = 0.0;  // the figure of Tolerance::kind, pixels of the final image per texel

  // Of these many samples: the read-back's pixels at shadow edges, on the planes that its depths
  // tell (at a crease that may be another surface's). Nothing is promised for what lies between.
  int64_t num_samples = 0;
};

// A tolerance is about squared footprints, whatever FitOptions::metric says: the options with that
// put right, which a view must be made with.
FitOptions ToleranceOptions(FitOptions options);

// Errors are those of FitLight(), and InvalidArgument for a tolerance or rules that cannot be used.
// A tolerance out of reach of the largest map is a result.
absl::StatusOr<ToleranceMap> MeetTolerance(const LightView& view,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options = {});
absl::StatusOr<ToleranceMap> MeetTolerance(const Readback& readback,
                                           const Light& light,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options = {});

// The same from a summary, for Kind::kRms and a summary in Metric::kL2: InvalidArgument otherwise,
// as sums know nothing of single samples.
absl::StatusOr<ToleranceMap> MeetTolerance(const Summary& summary,
                                           const Light& light,
                                           const Tolerance& tolerance,
                                           const MapSizeRules& rules,
                                           const FitOptions& options = {});

}  // namespace lightfit
