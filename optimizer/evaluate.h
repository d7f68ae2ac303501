// optimizer/evaluate.h
//
// How good somebody's matrix is, in the figures that a fit reports of its own.
// In:   a LightView (or read-back and light), a matrix and the size of its map, options.
// Out:  Figures, foretold wrong pixels among them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// `map_from_world` in texels, as LightMatrix::map_from_world; row 3 does not matter. Figures are
// over the view's samples, in FitOptions::metric, wrong pixels foretold with `border` around the
// map, without one with the view's; those of several matrices compare when view and options are the
// same, whatever their borders. With a read-back the border is that of the options, lit where they
// leave it open.
//
// InvalidArgument when an input is wrong or the matrix is not one of this light (MapFromRay());
// FailedPrecondition when all samples have w <= 0. Without any samples energy and footprints are 0.
absl::StatusOr<Figures> EvaluateMatrix(const LightView& view,
                                       const Eigen::Matrix4d& map_from_world,
                                       MapSize map,
                                       const FitOptions& options = {},
                                       std::optional<Border> border = std::nullopt);
absl::StatusOr<Figures> EvaluateMatrix(const Readback& readback,
                                       const Light& light,
                                       const Eigen::Matrix4d& map_from_world,
                                       MapSize map,
                                       const FitOptions& options = {});

}  // namespace lightfit
