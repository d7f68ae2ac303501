// optimizer/search/refine_ceres.h
//
// Refiner::kCeres: the refinement by ceres::Solve, whose report people know.
// In:   the reduced energy's cost, where to begin.
// Out:  better parameters, Ceres' brief report.
//
// Apart, as it alone links Ceres, and with it SuiteSparse, BLAS and glog; in builds without it
// (LIGHTFIT_WITH_CERES=OFF) HasCeres() is false and ValidateSearchOptions() refuses kCeres. Its
// twin Refiner::kTinySolver is a header of Ceres that needs none of them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "optimizer/search/refine.h"

namespace lightfit {

// Where both refiners end: iterations, and steps and gains (of the start's energy).
struct RefineLimits {
  int max_iterations = 8;
  double step_tolerance = 1e-5;
  double energy_tolerance = 1e-5;
};

bool HasCeres();

// Requires parameters at which the cost can be evaluated. Without Ceres they stay as they are.
std::string SolveWithCeres(const ReducedEnergyCost& cost,
                           const RefineLimits& limits,
                           Eigen::Vector2d* parameters);

}  // namespace lightfit
