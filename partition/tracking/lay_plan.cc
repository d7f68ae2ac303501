#include "partition/tracking/lay_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "geometry/homography.h"
#include "optimizer/figures/figures.h"
#include "optimizer/fit_matrix.h"
#include "partition/finish_plan.h"
#include "partition/map_depths.h"

namespace lightfit {

namespace {

LightPlan EmptyPlan(const LightView& view) {
  LightPlan plan;
  plan.light_name = view.light->name;
  plan.border = view.border;
  plan.facing = view.facing();
  return plan;
}

LightMatrix UnusedMap(const LightView& view, const KeptMap& map) {
  LightMatrix matrix;
  matrix.light_name = view.light->name;
  matrix.map = map.size;
  matrix.border = view.border;
  matrix.facing = view.facing();
  matrix.map_from_world = map.map_from_world;
  return matrix;
}

// A map's matrix and figures, with a depth row that has what `summary` covers.
absl::StatusOr<LightMatrix> LayMap(const LightView& view,
                                   const KeptMap& map,
                                   const Summary& summary,
                                   const Samples& samples,
                                   const FitOptions& fit) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, *view.light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const SearchInputs inputs = {
      *view.light, summary, samples.size() > 0 ? &samples : nullptr, view.surfaces};
  absl::StatusOr<LightMatrix> matrix = MatrixOfMap(
      inputs, *map_from_ray * summary.cover.normalized_from_ray.inverse(), map.size, fit);
  if (!matrix.ok()) return matrix.status();
  for (const int row : {0, 1, 3}) matrix->map_from_world.row(row) = map.map_from_world.row(row);
  return matrix;
}

DepthRange Widened(DepthRange depth, const Light& light, double room) {
  if (light.kind == Light::Kind::kPoint) {
    return {depth.near / (1.0 + room), depth.far * (1.0 + room)};
  }
  const double extent = depth.far - depth.near;
  return {depth.near - room * extent, depth.far + room * extent};
}

bool DepthFits(const Eigen::Matrix4d& map_from_world,
               const ScratchVector<Eigen::Vector4d>& corners) {
  constexpr double kTolerance = 1e-9;  // of the range of depth: rounding
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector4d& corner) {
    const Eigen::Vector4d at = map_from_world * corner;
    return at.w() > 0.0 && at.z() >= -kTolerance * at.w() && at.z() <= (1.0 + kTolerance) * at.w();
  });
}

}  // namespace

absl::StatusOr<LightPlan> LayPlan(const LightView& view,
                                  const KeptMaps& maps,
                                  const HeldBins& held,
                                  const FitOptions& fit,
                                  double guard_texels,
                                  double depth_room) {
  LightPlan plan = EmptyPlan(view);
  const ScratchVector<RayMap> ray_maps = RayMapsOf(maps);
  ScratchVector<Eigen::Matrix4d> matrices;
  for (const KeptMap& map : maps) matrices.push_back(map.map_from_world);
  const ScratchVector<MapDepths> depths =
      FindMapDepths(view, fit, ray_maps, matrices, guard_texels);
  ScratchVector<Samples> samples = SamplesByMap(view, ray_maps, guard_texels);
  for (size_t k = 0; k < maps.size(); ++k) {
    const int index = static_cast<int>(k);
    std::optional<CoverOfCell> cover = FindCoverOfCell(held.rays, held.BinsOf(index), *view.light);
    if (!cover.has_value()) {
      cover = FindCoverOfCell(held.rays, held.BinsIn(index), *view.light);
    }
    if (cover.has_value()) {
      const CellInputs inputs = InputsOfCell(view, held.rays, *cover, std::move(samples[k]), fit);
      absl::StatusOr<LightMatrix> matrix =
          LayMap(view, maps[k], inputs.summary, inputs.samples, fit);
      if (!matrix.ok()) return matrix.status();
      plan.maps.push_back(*std::move(matrix));
    } else {
      // It holds nothing that has area.
      plan.maps.push_back(UnusedMap(view, maps[k]));
      plan.maps.back().figures =
          MeasureFigures(samples[k], maps[k].rays.map_from_ray, fit.metric, fit.along_edge_share);
    }
    LightMatrix& laid = plan.maps.back();
    if (!std::isfinite(laid.figures.energy) || !std::isfinite(laid.figures.footprint.worst)) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "light \"%s\": map %d is singular at the samples", view.light->name, index));
    }
    if (!IsRedrawn(maps[k].action) && depths[k].Fits()) {
      laid.map_from_world.row(2) = maps[k].map_from_world.row(2);
    } else if (depths[k].IsAsked()) {
      LayDepthRow(*view.light, depths[k], held.rays.distance, depth_room, &laid.map_from_world);
    }
    plan.energy += laid.figures.energy;
  }
  return plan;
}

absl::StatusOr<LightPlan> LayPlanOfOne(const LightView& view,
                                       const KeptMap& map,
                                       const FitOptions& fit,
                                       double depth_room) {
  if (!view.cover.ok()) return view.cover.status();
  Summary summary;
  summary.metric = WeightsOf(fit.metric, fit.along_edge_share);
  summary.facing = view.facing();
  summary.counts = view.samples.counts;
  summary.cover = *view.cover;
  const bool keeps_depth =
      !IsRedrawn(map.action) &&
      DepthFits(map.map_from_world, CornersOfCover(summary.cover, *view.light));
  summary.cover.depth = Widened(summary.cover.depth, *view.light, depth_room);
  absl::StatusOr<LightMatrix> matrix = LayMap(view, map, summary, view.samples, fit);
  if (!matrix.ok()) return matrix.status();
  if (keeps_depth) matrix->map_from_world.row(2) = map.map_from_world.row(2);
  LightPlan plan = EmptyPlan(view);
  plan.energy = matrix->figures.energy;
  plan.maps.push_back(*std::move(matrix));
  return plan;
}

LightPlan LayUnused(const LightView& view, const KeptMaps& maps) {
  LightPlan plan = EmptyPlan(view);
  for (const KeptMap& map : maps) plan.maps.push_back(UnusedMap(view, map));
  return plan;
}

}  // namespace lightfit
