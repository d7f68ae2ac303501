#include "partition/evaluate_plan.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/homography.h"
#include "optimizer/figures/foretell.h"

namespace lightfit {

namespace {

// The samples that ask each map.
ScratchVector<Samples> SamplesAskingEach(const LightView& view, const PlanLookUp& look_up) {
  ScratchVector<Samples> by_map(look_up.num_maps());
  for (Samples& samples : by_map) samples.ray_from_screen = view.samples.ray_from_screen;
  for (size_t i = 0; i < view.samples.size() && !IsStopped(i); ++i) {
    const Eigen::Vector4d screen(view.samples.x[i], view.samples.y[i], view.samples.d[i], 1.0);
    const PlanPlace place = look_up.At((view.surfaces->world_from_screen * screen).hnormalized());
    if (place.map >= 0) by_map[place.map].AppendFrom(view.samples, i);
  }
  return by_map;
}

}  // namespace

absl::StatusOr<Figures> MeasurePlan(const LightView& view,
                                    const Plan& plan,
                                    const FitOptions& options,
                                    double guard_texels,
                                    ScratchVector<Figures>* of_maps) {
  const Light& light = *view.light;
  if (of_maps != nullptr) of_maps->clear();
  if (absl::Status status = CheckServes(view, options); !status.ok()) return status;
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light, guard_texels);
  if (!look_up.ok()) return look_up.status();
  const ScratchVector<Samples> by_map = SamplesAskingEach(view, *look_up);
  const Eigen::Matrix3d ray_from_normalized = view.normalized_from_ray().inverse();
  Figures figures;
  FootprintSet footprints;
  size_t num_asked = 0;
  for (size_t k = 0; k < plan.maps.size(); ++k) {
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray =
        MapFromRay(plan.maps[k].map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    const Eigen::Matrix3d map_from_normalized = *map_from_ray * ray_from_normalized;
    Figures of_map;
    if (of_maps != nullptr) {
      of_map =
          MeasureFigures(by_map[k], map_from_normalized, options.metric, options.along_edge_share);
      of_map.samples = view.samples.counts;
      of_map.samples.used = static_cast<int64_t>(by_map[k].size());
      of_maps->push_back(of_map);
    } else {
      of_map.energy =
          MeasureEnergy(by_map[k], map_from_normalized, options.metric, options.along_edge_share);
    }
    figures.energy += of_map.energy;
    footprints.Add(map_from_normalized, by_map[k]);
    num_asked += by_map[k].size();
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  figures.samples = view.samples.counts;
  figures.footprint = footprints.Statistics();
  figures.footprint.num_behind += static_cast<int64_t>(view.samples.size() - num_asked);
  if (num_asked == 0 && view.samples.size() > 0) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": all %d samples are outside of all %d maps",
                        light.name,
                        view.samples.size(),
                        plan.maps.size()));
  }
  if (!std::isfinite(figures.energy) || !std::isfinite(figures.footprint.worst)) {
    return absl::FailedPreconditionError(
        absl::StrFormat("light \"%s\": a matrix is singular at the samples", light.name));
  }
  return figures;
}

absl::StatusOr<Figures> EvaluatePlan(const LightView& view,
                                     const Plan& plan,
                                     const FitOptions& options,
                                     double guard_texels) {
  absl::StatusOr<Figures> figures = MeasurePlan(view, plan, options, guard_texels);
  if (!figures.ok()) return figures.status();
  const absl::StatusOr<double> wrong_share =
      ForetellPlan(view.surfaces->readback, *view.light, plan, options.samples);
  if (!wrong_share.ok()) return wrong_share.status();
  figures->wrong_share = *wrong_share;
  return figures;
}

absl::StatusOr<double> ForetellPlan(const Readback& readback,
                                    const Light& light,
                                    const Plan& plan,
                                    const SampleOptions& samples) {
  ScratchVector<SizedMatrix> maps;
  for (const PlanMap& map : plan.maps) maps.push_back({map.map_from_world, map.size});
  return ForetellWrongShare(readback, light, maps, samples, plan.border);
}

}  // namespace lightfit
