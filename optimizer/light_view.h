// optimizer/light_view.h
//
// One light of a read-back, made ready once to be fitted and judged as often as one likes: the
// stations of FitLight() one by one.
// In:   Receivers, Light, FitOptions (checked by ValidateFitOptions()).
// Out:  PreparedLight {samples, summary}; from it a LightMatrix, and the matrix of any other map.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

struct PreparedLight {
  Samples samples;  // in the summary's normalised rays
  Summary summary;
};

// Here and below: CancelledError once a StopScope says so.

// FailedPrecondition as CoverReceivers(). A light without any sample is a result.
absl::StatusOr<PreparedLight> PrepareLight(const Receivers& receivers,
                                           const Light& light,
                                           const FitOptions& options);

// The fit: search, then the matrix. `map` has passed ValidateMapSize().
absl::StatusOr<LightMatrix> FitInputs(const SearchInputs& inputs,
                                      MapSize map,
                                      const FitOptions& options);

// The same without the search: the matrix of a map that is there already (rows h1, h2 and p, from
// the summary's normalised rays), with its depth row laid over these receivers, and its figures.
// A mirrored map is turned over.
// InvalidArgument when w <= 0 on a ray that is to be covered.
absl::StatusOr<LightMatrix> MatrixOfMap(const SearchInputs& inputs,
                                        const Eigen::Matrix3d& map_from_normalized,
                                        MapSize map,
                                        const FitOptions& options);

}  // namespace lightfit
