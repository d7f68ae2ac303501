// optimizer/choose_fit.h
//
// Several fits of one light, and the one of them of which the fewest wrong pixels are foretold.
// In:   Surfaces, Light, MapSize, FitOptions.
// Out:  LightMatrix, its border and foretold share.
#pragma once

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// How much less must be foretold for a fit to be taken instead of the one before it: forecasts err,
// and what is usual wins where they tell nothing; a finer cover need only be better.
// docs/defaults.md
inline constexpr double kDarkBorderBelow = 0.85;
inline constexpr double kPeerBelow = 0.9;

// What BorderChoice::kAutomatic stands for. In this order: the fit that the options ask for with a
// lit border; with a dark one, where the read-back has the third state; both with the finer cover,
// where the read-back has one (Readback::fine_cover); and with the third state, beside the global
// search, the focused map and Algorithm 1 as published, so that nobody gets a matrix that is
// foretold to be worse than what people know. Errors are those of the first where none of them has
// a matrix.
absl::StatusOr<LightMatrix> FitByForecast(const Surfaces& surfaces,
                                          const Light& light,
                                          MapSize map,
                                          const FitOptions& options);

// The border of the same choice alone, for who fits over and over: the fits of the options, roomy
// or not, with either border. `current`: that of the matrix in use, which the other must beat. kLit
// where the read-back has no third state or nothing can be foretold.
Border BorderByForecast(const Surfaces& surfaces,
                        const Light& light,
                        MapSize map,
                        const FitOptions& options,
                        Border current = Border::kLit);

}  // namespace lightfit
