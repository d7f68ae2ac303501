#include "optimizer/evaluate.h"

#include <Eigen/LU>
#include <cmath>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "optimizer/figures/foretell.h"

namespace lightfit {

absl::StatusOr<Figures> EvaluateMatrix(const LightView& view,
                                       const Eigen::Matrix4d& map_from_world,
                                       MapSize map,
                                       const FitOptions& options,
                                       std::optional<Border> border) {
  const Light& light = *view.light;
  if (absl::Status status = CheckServes(view, options); !status.ok()) return status;
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const Eigen::Matrix3d map_from_normalized = *map_from_ray * view.normalized_from_ray().inverse();
  Figures figures =
      MeasureFigures(view.samples, map_from_normalized, options.metric, options.along_edge_share);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  const int64_t num_behind = figures.footprint.num_behind;
  if (num_behind > 0 && num_behind == figures.samples.used) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": w <= 0 at all %d samples: the map looks the other way",
                        light.name,
                        num_behind));
  }
  if (!std::isfinite(figures.energy) || !std::isfinite(figures.footprint.worst)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": the matrix is singular at the samples", light.name));
  }
  const absl::StatusOr<double> wrong_share = ForetellWrongShare(view.surfaces->readback,
                                                                light,
                                                                map_from_world,
                                                                map,
                                                                options.samples,
                                                                border.value_or(view.border));
  if (!wrong_share.ok()) return wrong_share.status();
  figures.wrong_share = *wrong_share;
  return figures;
}

absl::StatusOr<Figures> EvaluateMatrix(const Readback& readback,
                                       const Light& light,
                                       const Eigen::Matrix4d& map_from_world,
                                       MapSize map,
                                       const FitOptions& options) {
  return AskView(readback, light, options, [&](const LightView& view) {
    return EvaluateMatrix(view, map_from_world, map, options);
  });
}

}  // namespace lightfit
