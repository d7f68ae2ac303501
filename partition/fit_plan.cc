#include "partition/fit_plan.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "geometry/light_map.h"
#include "optimizer/choose_fit.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "partition/divided_maps.h"
#include "partition/find_cells.h"

namespace lightfit {

namespace {

// A square map of at most so many texels.
MapSize SquareOf(int64_t texels) {
  const int side = static_cast<int>(std::sqrt(static_cast<double>(texels)));
  return {side, side};
}

// Of about this shape, and of no more texels.
MapSize WholeSize(const CellMap& map, double texels) {
  const double aspect = map.width / map.height;
  const int width = std::clamp(
      static_cast<int>(std::lround(std::sqrt(texels * aspect))), 1, static_cast<int>(texels));
  const int height = std::max(1, static_cast<int>(texels / width));
  return {std::min(width, kMaxMapSide), std::min(height, kMaxMapSide)};
}

absl::StatusOr<LightPlan> PlanOfOneMap(const Surfaces& surfaces,
                                       const Light& light,
                                       const PlanOptions& options) {
  FitOptions fit = options.fit;
  fit.margin_texels += options.guard_texels;
  const absl::StatusOr<LightMatrix> matrix =
      FitLight(surfaces, light, options.each.value_or(SquareOf(options.texels)), fit);
  if (!matrix.ok()) return matrix.status();
  LightPlan plan;
  plan.light_name = matrix->light_name;
  plan.border = matrix->border;
  plan.facing = matrix->facing;
  plan.energy = matrix->figures.energy;
  plan.maps.push_back(*matrix);
  return plan;
}

// Makes the matrices of fitted cells.
class Finisher {
 public:
  Finisher(const LightView& view, const CellFitter& fitter, const PlanOptions& options)
      : view_(view), fitter_(fitter), options_(options) {}

  absl::StatusOr<LightPlan> Finish(const Cells& cells) const {
    LightPlan plan;
    plan.light_name = view_.light->name;
    plan.border = view_.border;
    plan.facing = view_.facing();
    ScratchVector<MapOfCell> maps;
    const ScratchVector<double> texels =
        DivideTexels(fitter_, cells, static_cast<double>(options_.texels));
    for (size_t k = 0; k < cells.size(); ++k) {
      const MapSize size = options_.each.value_or(WholeSize(cells[k].map, texels[k]));
      std::optional<Eigen::Matrix3d> map_from_ray = fitter_.MapOfSize(
          cells[k].bins, cells[k].map, size, options_.guard_texels + options_.fit.margin_texels);
      const std::optional<CellCover> cover = CoverBins(fitter_.rays(), cells[k].bins, *view_.light);
      if (!map_from_ray.has_value() || !cover.has_value()) continue;
      maps.push_back({Unmirrored(*map_from_ray, size), size, *cover, NearOf(cells[k], *cover)});
    }
    const ScratchVector<Samples> samples = SamplesByMap(maps);
    for (size_t k = 0; k < maps.size(); ++k) {
      absl::StatusOr<LightMatrix> matrix = MatrixOf(maps[k], samples[k]);
      if (!matrix.ok()) return matrix.status();
      plan.energy += matrix->figures.energy;
      plan.maps.push_back(*std::move(matrix));
    }
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    if (plan.maps.empty()) {
      return absl::FailedPreconditionError(absl::StrFormat(
          "light \"%s\": %d texels are too few for any map", view_.light->name, options_.texels));
    }
    return plan;
  }

 private:
  struct MapOfCell {
    Eigen::Matrix3d map_from_ray;  // of ServedRays' rays
    MapSize size;
    CellCover cover;
    double near;  // least X'_3 of a covered receiver in the cover's rays; point lights
  };

  double NearOf(const Cell& cell, const CellCover& cover) const {
    if (view_.light->kind != Light::Kind::kPoint) return 0.0;
    const Eigen::Matrix3d light_from_ray = fitter_.rays().normalized_from_ray.inverse();
    double near = std::numeric_limits<double>::infinity();
    for (const int index : cell.bins) {
      const RayBin& bin = fitter_.rays().bins[index];
      for (const Eigen::Vector3d& ray : bin.hull) {
        const double unit = (light_from_ray * ray).norm();
        near = std::min(near, bin.nearest * cover.normalized_from_ray.row(2).dot(ray) / unit);
      }
    }
    return near;
  }

  // The boundary samples that ask each map, in the rays of its cover.
  ScratchVector<Samples> SamplesByMap(const ScratchVector<MapOfCell>& maps) const {
    ScratchVector<Samples> by_map;
    for (const MapOfCell& map : maps) {
      Samples& samples = by_map.emplace_back();
      samples.ray_from_screen = map.cover.normalized_from_ray * view_.samples.ray_from_screen;
      samples.counts = view_.samples.counts;
      samples.counts.used = 0;
    }
    for (size_t i = 0; i < view_.samples.size(); ++i) {
      const Eigen::Vector3d ray = view_.samples.At(i).X;
      int asked = -1;
      double least = std::numeric_limits<double>::infinity();
      for (size_t k = 0; k < maps.size(); ++k) {
        const Eigen::Vector3d at = maps[k].map_from_ray * ray;
        const double q = at.z() / std::cbrt(std::abs(maps[k].map_from_ray.determinant()));
        const bool is_inside = at.z() > 0.0 && at.x() >= 0.0 && at.y() >= 0.0 &&
                               at.x() < maps[k].size.width * at.z() &&
                               at.y() < maps[k].size.height * at.z();
        if (!is_inside || q >= least) continue;
        least = q;
        asked = static_cast<int>(k);
      }
      if (asked < 0) continue;
      by_map[asked].AppendFrom(view_.samples, i);
      ++by_map[asked].counts.used;
    }
    return by_map;
  }

  absl::StatusOr<LightMatrix> MatrixOf(const MapOfCell& map, const Samples& samples) const {
    const ServedRays& rays = fitter_.rays();
    const Eigen::Matrix3d cover_from_light =
        map.cover.normalized_from_ray * rays.normalized_from_ray;
    Summary summary;
    summary.metric = WeightsOf(options_.fit.metric, options_.fit.along_edge_share);
    summary.facing = view_.facing();
    summary.counts = samples.counts;
    summary.cover.normalized_from_ray = cover_from_light;
    summary.cover.hull = map.cover.hull;
    summary.cover.border = view_.border;
    summary.cover.depth = rays.distance;
    if (view_.light->kind == Light::Kind::kPoint) {
      // Nothing is further along the third row than its length times the distance.
      summary.cover.depth = {map.near, cover_from_light.row(2).norm() * rays.distance.far};
    }
    const SearchInputs inputs = {
        *view_.light, summary, samples.size() > 0 ? &samples : nullptr, view_.surfaces};
    return MatrixOfMap(
        inputs, map.map_from_ray * map.cover.normalized_from_ray.inverse(), map.size, options_.fit);
  }

  const LightView& view_;
  const CellFitter& fitter_;
  const PlanOptions& options_;
};

absl::StatusOr<LightPlan> FitInBorder(const Surfaces& surfaces,
                                      const Light& light,
                                      Border border,
                                      const PlanOptions& options) {
  FitOptions fit = options.fit;
  fit.border = BorderChoice::kAutomatic;  // that of the view
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, border, fit);
  if (!view.ok()) return view.status();
  const absl::StatusOr<ServedRays> rays = FindServedRays(*view, fit);
  if (!rays.ok()) return rays.status();
  const CellFitter fitter(*rays, light, fit);
  const double texels = options.each.has_value() ? static_cast<double>(options.each->width) *
                                                       options.each->height * options.max_maps
                                                 : static_cast<double>(options.texels);
  ScratchVector<Cells> grown = GrowCells(fitter, options.max_maps);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  if (grown.empty()) return view->cover.ok() ? absl::UnknownError("no map") : view->cover.status();
  const Cells cells = AlternateCells(fitter, grown.back(), texels);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return Finisher(*view, fitter, options).Finish(cells);
}

}  // namespace

Plan PlanOf(const LightPlan& plan) {
  Plan result;
  result.light_name = plan.light_name;
  result.border = plan.border;
  for (const LightMatrix& map : plan.maps) {
    PlanMap& added = result.maps.emplace_back();
    added.map_from_world = map.map_from_world;
    added.size = map.map;
  }
  return result;
}

absl::StatusOr<LightPlan> FitPlan(const Surfaces& surfaces,
                                  const Light& light,
                                  const PlanOptions& options) {
  if (absl::Status status = ValidatePlanOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (options.max_maps == 1) return PlanOfOneMap(surfaces, light, options);
  const bool is_dark = options.fit.border == BorderChoice::kDark;
  return FitInBorder(surfaces, light, is_dark ? Border::kDark : Border::kLit, options);
}

}  // namespace lightfit
