#include "partition/finish_plan.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/light_map.h"
#include "optimizer/fit_matrix.h"
#include "partition/map_depths.h"
#include "partition/plan_sizes.h"

namespace lightfit {

absl::StatusOr<ScratchVector<MapOfCell>> MapsOfCells(const CellFitter& fitter,
                                                     const Cells& cells,
                                                     const PlanOptions& options) {
  const absl::StatusOr<ScratchVector<MapSize>> sizes = SizesOfCells(fitter, cells, options);
  if (!sizes.ok()) return sizes.status();
  const double margin_texels = options.guard_texels + options.fit.margin_texels;
  ScratchVector<MapOfCell> maps;
  for (size_t k = 0; k < cells.size(); ++k) {
    const MapSize size = (*sizes)[k];
    if (!(2.0 * margin_texels < std::min(size.width, size.height))) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "light \"%s\": options.guard_texels = %g and fit.margin_texels = %g on "
          "every side leave nothing of a map of %dx%d texels, one of %d; want fewer "
          "maps or more texels",
          fitter.light().name,
          options.guard_texels,
          options.fit.margin_texels,
          size.width,
          size.height,
          cells.size()));
    }
    const std::optional<Eigen::Matrix3d> map_from_ray =
        fitter.MapOfSize(cells[k].bins, cells[k].map, size, margin_texels);
    const std::optional<CoverOfCell> cover =
        FindCoverOfCell(fitter.rays(), cells[k].bins, fitter.light());
    if (!map_from_ray.has_value() || !cover.has_value()) continue;
    maps.push_back({Unmirrored(*map_from_ray, size), size, *cover});
  }
  return maps;
}

absl::StatusOr<LightPlan> FinishPlan(const LightView& view,
                                     const CellFitter& fitter,
                                     const Cells& cells,
                                     const PlanOptions& options) {
  LightPlan plan;
  plan.light_name = view.light->name;
  plan.border = view.border;
  plan.facing = view.facing();
  const absl::StatusOr<ScratchVector<MapOfCell>> found = MapsOfCells(fitter, cells, options);
  if (!found.ok()) return found.status();
  const ScratchVector<MapOfCell>& maps = *found;
  ScratchVector<RayMap> ray_maps;
  for (const MapOfCell& map : maps) {
    ray_maps.push_back(RayMap(map.map_from_ray, map.size.width, map.size.height));
  }
  ScratchVector<Samples> samples = SamplesByMap(view, ray_maps, options.guard_texels);
  for (size_t k = 0; k < maps.size(); ++k) {
    const CellInputs inputs =
        InputsOfCell(view, fitter.rays(), maps[k].cover, std::move(samples[k]), options.fit);
    absl::StatusOr<LightMatrix> matrix = MatrixOfMap(
        inputs.Of(view), maps[k].map_from_ray * inputs.ray_from_cover, maps[k].size, options.fit);
    if (!matrix.ok()) return matrix.status();
    plan.energy += matrix->figures.energy;
    plan.maps.push_back(*std::move(matrix));
  }
  ScratchVector<Eigen::Matrix4d> matrices;
  for (const LightMatrix& map : plan.maps) matrices.push_back(map.map_from_world);
  const ScratchVector<MapDepths> depths =
      FindMapDepths(view, options.fit, ray_maps, matrices, options.guard_texels);
  for (size_t k = 0; k < maps.size(); ++k) {
    if (depths[k].Fits()) continue;
    LayDepthRow(*view.light,
                depths[k],
                fitter.rays().distance,
                /*room=*/0.0,
                &plan.maps[k].map_from_world);
  }
  if (absl::Status status = CheckStop(*view.light); !status.ok()) return status;
  if (plan.maps.empty()) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": %d texels are too few for any map", view.light->name, options.texels));
  }
  return plan;
}

std::optional<CoverOfCell> FindCoverOfCell(const ServedRays& rays, Bins bins, const Light& light) {
  std::optional<CellCover> cone = CoverBins(rays, bins, light);
  if (!cone.has_value()) return std::nullopt;
  CoverOfCell cover = {*std::move(cone), 0.0};
  if (light.kind != Light::Kind::kPoint) return cover;
  const Eigen::Matrix3d light_from_ray = rays.normalized_from_ray.inverse();
  cover.near = std::numeric_limits<double>::infinity();
  for (const int index : bins) {
    const RayBin& bin = rays.bins[index];
    for (const Eigen::Vector3d& ray : bin.hull) {
      const double unit = (light_from_ray * ray).norm();
      cover.near = std::min(
          cover.near, bin.distance.near * cover.cone.normalized_from_ray.row(2).dot(ray) / unit);
    }
  }
  return cover;
}

ScratchVector<Samples> SamplesByMap(const LightView& view,
                                    absl::Span<const RayMap> maps,
                                    double guard_texels) {
  ScratchVector<Samples> by_map(maps.size());
  for (Samples& samples : by_map) {
    samples.ray_from_screen = view.samples.ray_from_screen;
    samples.counts = view.samples.counts;
    samples.counts.used = 0;
  }
  for (size_t i = 0; i < view.samples.size(); ++i) {
    const int asked = DensestAt(maps, view.samples.At(i).X, guard_texels);
    if (asked < 0) continue;
    by_map[asked].AppendFrom(view.samples, i);
    ++by_map[asked].counts.used;
  }
  return by_map;
}

CellInputs InputsOfCell(const LightView& view,
                        const ServedRays& rays,
                        const CoverOfCell& cover,
                        Samples samples,
                        const FitOptions& options) {
  const Eigen::Matrix3d cover_from_light =
      cover.cone.normalized_from_ray * rays.normalized_from_ray;
  CellInputs inputs;
  inputs.ray_from_cover = cover.cone.normalized_from_ray.inverse();
  inputs.samples = std::move(samples);
  inputs.samples.ray_from_screen = cover.cone.normalized_from_ray * view.samples.ray_from_screen;
  inputs.summary.metric = WeightsOf(options.metric, options.along_edge_share);
  inputs.summary.facing = view.facing();
  inputs.summary.counts = inputs.samples.counts;
  inputs.summary.cover.normalized_from_ray = cover_from_light;
  inputs.summary.cover.hull = cover.cone.hull;
  inputs.summary.cover.border = view.border;
  inputs.summary.cover.depth = rays.distance;
  if (view.light->kind == Light::Kind::kPoint) {
    // Nothing is further along the third row than its length times the distance.
    inputs.summary.cover.depth = {cover.near, cover_from_light.row(2).norm() * rays.distance.far};
  }
  return inputs;
}

}  // namespace lightfit
