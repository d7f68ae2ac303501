// optimizer/figures/evaluate.h
//
// How good somebody's matrix is, in the figures that a fit reports of its own.
// In:   Readback, Light, a matrix and the size of its map, the options that say what counts.
// Out:  MatrixFigures.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct MatrixFigures {
  double energy = 0;  // as LightMatrix::energy: FitOptions::metric over FitOptions::samples
  FootprintStatistics footprint;
  double wrong_share = 0;  // ForetellWrongShare()
  SampleCounts samples;
  int64_t num_behind = 0;  // samples with w <= 0: outside the map, not in energy and footprint
};

// `map_from_world` in texels, as LightMatrix::map_from_world; row 3 does not matter. Energies of
// several matrices compare when read-back, light and options are the same.
//
// InvalidArgument when an input is wrong or the matrix is not one of this light (MapFromRay());
// FailedPrecondition when all samples have w <= 0. Without any samples energy and footprints are 0.
absl::StatusOr<MatrixFigures> EvaluateMatrix(const Readback& readback,
                                             const Light& light,
                                             const Eigen::Matrix4d& map_from_world,
                                             MapSize map,
                                             const FitOptions& options = {});

}  // namespace lightfit
