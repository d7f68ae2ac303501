// optimizer/fit_matrix.h
//
// From what a search works on to a LightMatrix: search, lay the depth row, say how good it is.
// In:   SearchInputs {light, summary, samples, surfaces}, a map size; or a map that is there.
// Out:  LightMatrix.   math.md 8
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

// Here and below: CancelledError once a StopScope says so.

// The fit: search, then the matrix. `map` has passed ValidateMapSize().
absl::StatusOr<LightMatrix> FitMatrix(const SearchInputs& inputs,
                                      MapSize map,
                                      const FitOptions& options,
                                      SearchEffort effort = SearchEffort::kUsual);

// The same without the search: the matrix of a map that is there already (rows h1, h2 and p, from
// the summary's normalised rays), with its depth row laid over these receivers, and its figures.
// A mirrored map is turned over.
// InvalidArgument when w <= 0 on a ray that is to be covered.
absl::StatusOr<LightMatrix> MatrixOfMap(const SearchInputs& inputs,
                                        const Eigen::Matrix3d& map_from_normalized,
                                        MapSize map,
                                        const FitOptions& options);

}  // namespace lightfit
