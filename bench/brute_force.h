// bench/brute_force.h
//
// The least energy that any light matrix can have, found the slow way: the yardstick for quality.
// In:   a summary (energy tensor and hull of the rays), the map's size, the fit's margins, min_w.
// Out:  the energy of the best matrix found.
//
// Shares with the library only the tensor and the hull. Axes are a dense grid over the polar
// polygon; at each, the enclosing parallelogram is the best pair of strips on a dense grid of both
// angles. Around the best of the grid both grids are refined, and a random search in all four
// unknowns at once finishes.
#pragma once

#include <cstdint>

#include "geometry/map_size.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"

namespace lightfit {

struct BruteForceOptions {
  int num_directions = 48;  // spokes of the grid over the polar polygon
  int num_radii = 24;       // points on a spoke
  int num_angles = 90;      // strip angles over half a turn
  int num_refined = 5;      // well separated points of the grid that are refined
  int num_trials = 10000;   // of the random search
  uint64_t seed = 1;
};

struct BruteForceResult {
  double energy = 0.0;       // infinite if the grid holds no usable axis
  double a = 0.0, b = 0.0;   // the axis p = (a, b, 1), normalised rays
  double angle_u_rad = 0.0;  // of the strips' normals, X_3 = 1 seen along p, where M = I
  double angle_v_rad = 0.0;
};

BruteForceResult BruteForceFit(const Summary& summary,
                               MapSize map,
                               const FitOptions& fit_options,
                               const BruteForceOptions& options = {});

}  // namespace lightfit
