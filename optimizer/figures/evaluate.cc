#include "optimizer/figures/evaluate.h"

#include <Eigen/LU>
#include <cmath>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/energy/l1_weights.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

absl::StatusOr<MatrixFigures> EvaluateMatrix(const Readback& readback,
                                             const Light& light,
                                             const Eigen::Matrix4d& map_from_world,
                                             MapSize map,
                                             const FitOptions& options) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options.samples);
  if (!receivers.ok()) return receivers.status();
  // Normalised rays keep precision however far the light is; where receivers surround it, it is
  // near enough for light space to do.
  Eigen::Matrix3d normalized_from_ray = Eigen::Matrix3d::Identity();
  const absl::StatusOr<RayCover> cover =
      CoverReceivers(*receivers, light, Cover::kShadowed);
  if (cover.ok()) normalized_from_ray = cover->normalized_from_ray;
  const Samples all_samples = SelectSamples(
      *receivers, light, normalized_from_ray, /*with_edge_normals=*/true);
  const Eigen::Matrix3d map_from_normalized = *map_from_ray * normalized_from_ray.inverse();
  const Samples samples = SamplesInFront(all_samples, map_from_normalized.row(2));
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (samples.size() == 0 && all_samples.size() > 0) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": w <= 0 at all %d samples: the map looks the other way",
                        light.name,
                        all_samples.size()));
  }
  MatrixFigures figures;
  figures.samples = samples.counts;
  figures.num_behind = static_cast<int64_t>(all_samples.size() - samples.size());
  const absl::StatusOr<double> wrong_share =
      ForetellWrongShare(readback, light, map_from_world, map, options.samples);
  if (!wrong_share.ok()) return wrong_share.status();
  figures.wrong_share = *wrong_share;
  if (samples.size() == 0) return figures;
  figures.footprint = ComputeFootprintStatistics(map_from_normalized, samples);
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  figures.energy =
      IsL1(options.metric)
          ? WeightsForL1(samples, metric, map_from_normalized).footprint_sum
          : Energy(map_from_normalized, samples, metric);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (!std::isfinite(figures.energy) || !std::isfinite(figures.footprint.worst)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": the matrix is singular at the samples", light.name));
  }
  return figures;
}

}  // namespace lightfit
