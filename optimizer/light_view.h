// optimizer/light_view.h
//
// One light in one read-back: made once, and all that is asked about the light is asked of it.
// In:   Surfaces, a Light, FitOptions that say which samples count and what the map must cover.
// Out:  LightView {cover, samples}; what comes of it is in optimizer/fit.h and optimizer/figures.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/axis_search.h"

namespace lightfit {

struct LightView {
  const Surfaces* surfaces;  // must outlive the view, as must the light
  const Light* light;

  // What the map must have room for, or why no single map has: FailedPrecondition as
  // CoverReceivers(). Somebody's matrix can be judged all the same.
  absl::StatusOr<RayCover> cover;

  // In the cover's normalised rays, which keep precision however far the light is; in light space
  // where there is no cover, as receivers surround the light and it is near enough for that. May be
  // none. They have edge normals where FitOptions::metric counts what lies across edges.
  Samples samples;

  Eigen::Matrix3d normalized_from_ray() const {
    return cover.ok() ? cover->normalized_from_ray : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  }
};

// Here and below: CancelledError once a StopScope says so.

// Of `options` count `samples`, `cover` and whether `metric` needs edge normals; whoever takes the
// view wants the same. InvalidArgument for a light that cannot be used, or samples that the
// surfaces were not found for (FindSurfaces()).
absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
                                    const FitOptions& options);

// The samples summed up in the metric. Requires view.cover.ok().
Summary SummaryOfView(const LightView& view, const FitOptions& options);

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
