// optimizer/light_matrix.h
//
// The result of a fit: one matrix for one light, and how good it is.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>

#include "geometry/clip.h"
#include "geometry/scratch.h"

namespace lightfit {

// Where the candidate samples of one light went. Counts of read-back pixels.
struct SampleCounts {
  int64_t receivers = 0;      // pixels with a surface
  int64_t invalid_depth = 0;  // pixels with NaN, negative or out-of-range depth: ignored
  int64_t candidates = 0;     // pixels whose shadow bit differs from a neighbour's
  int64_t background = 0;     // candidates without a surface
  int64_t discontinuity = 0;  // candidates at a depth discontinuity
  int64_t facing_away = 0;    // candidates whose surface, or whose lit side, faces away
  int64_t edge_on = 0;        // candidates edge-on to the light or the eye
  int64_t used = 0;           // candidates - all of the above but receivers, invalid_depth
};

// How far one texel reaches on the screen: sqrt((|dS/du|^2 + |dS/dv|^2) / 2), so that a map that is
// one-to-one with the read-back has footprint 1. Read-back pixels per texel.
struct FootprintStatistics {
  double rms = 0;     // always there: it follows from the energy
  double median = 0;  // the rest are 0 unless FitOptions::compute_statistics
  double p99 = 0;
  double worst = 0;
};

enum class StopReason {
  kNoSearch,     // kFocused: there was nothing to search
  kConverged,    // no neighbour of the axis is better
  kRoundLimit,   // the rounds asked for are done
  kAxisAtLimit,  // the best axis lies on the limit of the warp (FitOptions::min_w)
};

const char* StopReasonName(StopReason reason);

// One accepted step of the search.
struct TraceStep {
  // A literal: "start", "line_search", "grid", "refine", "polish", "exact".
  std::string_view station;
  int evaluations = 0;  // matrices evaluated so far
  double energy = 0;
};

struct LightMatrix {
  ScratchString light_name;
  MapSize map;

  // Homogeneous (u w, v w, z w, w) of a world point: u, v in texels, (0, 0) the first texel's
  // corner, z in [0, 1] over the receivers, w > 0 on every receiver. Column vectors. In the middle
  // of the rays w is 1 for a directional light, and the distance along them for a point light.
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();

  // Sum over the samples in the metric that was minimised: of squared footprints, (read-back pixels
  // per texel)^2, or of footprints for the L1 metrics.   math.md (3)
  double energy = 0;
  double energy_start = 0;  // where the search began; energy never exceeds it

  FootprintStatistics footprint;
  SampleCounts samples;
  StopReason stop_reason = StopReason::kConverged;
  int evaluations = 0;
  ScratchVector<TraceStep> trace;
  std::string solver_report;  // Ceres' own words, Refiner::kCeres only

  // "sun: 1024x1024, energy 12.3 (start 20.1), rms 0.12 px, worst 0.8 px, converged"
  std::string BriefReport() const;
};

}  // namespace lightfit
