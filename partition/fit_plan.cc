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
#include "geometry/ray_maps.h"
#include "optimizer/choose_fit.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/fit_matrix.h"
#include "partition/divided_maps.h"
#include "partition/find_cells.h"
#include "partition/sphere_cells.h"

namespace lightfit {

namespace {

// How much less must be foretold for a plan of more maps to be taken: docs/plans.md.
constexpr double kMoreMapsBelow = 0.95;

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

LightPlan PlanOfOne(const LightMatrix& matrix) {
  LightPlan plan;
  plan.light_name = matrix.light_name;
  plan.border = matrix.border;
  plan.facing = matrix.facing;
  plan.energy = matrix.figures.energy;
  plan.wrong_share = matrix.figures.wrong_share;
  plan.maps.push_back(matrix);
  return plan;
}

// By the fit of one map, from `from`, a light in its surfaces or a view.
template <typename... From>
absl::StatusOr<LightPlan> PlanOfOneMap(const PlanOptions& options, const From&... from) {
  FitOptions fit = options.fit;
  fit.margin_texels += options.guard_texels;
  if constexpr (sizeof...(From) == 1) fit.border = BorderChoice::kAutomatic;  // that of the view
  const absl::StatusOr<LightMatrix> matrix =
      FitLight(from..., options.each.value_or(SquareOf(options.texels)), fit);
  if (!matrix.ok()) return matrix.status();
  return PlanOfOne(*matrix);
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
      const double margin = options_.guard_texels + options_.fit.margin_texels;
      if (!(2.0 * margin < std::min(size.width, size.height))) {
        return absl::FailedPreconditionError(
            absl::StrFormat("light \"%s\": options.guard_texels = %g leave nothing of a map of "
                            "%dx%d texels, one of "
                            "%d; want fewer maps or more texels",
                            view_.light->name,
                            options_.guard_texels,
                            size.width,
                            size.height,
                            cells.size()));
      }
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
    ScratchVector<RayMap> ray_maps;
    for (const MapOfCell& map : maps) {
      ray_maps.push_back(RayMap(map.map_from_ray, map.size.width, map.size.height));
    }
    for (size_t i = 0; i < view_.samples.size(); ++i) {
      const int asked = DensestAt(ray_maps, view_.samples.At(i).X);
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

// The best plan so far, by what is foretold where that is asked for.
class Choice {
 public:
  Choice(const Surfaces& surfaces, const Light& light, const PlanOptions& options)
      : surfaces_(surfaces), light_(light), options_(options) {}

  absl::Status Offer(LightPlan plan) {
    ScratchVector<SizedMatrix> maps;
    for (const LightMatrix& map : plan.maps) maps.push_back({map.map_from_world, map.map});
    const absl::StatusOr<double> share =
        ForetellWrongShare(surfaces_.readback, light_, maps, options_.fit.samples, plan.border);
    if (!share.ok()) return share.status();
    plan.wrong_share = *share;
    double below = 1.0;
    if (best_.has_value()) {
      const bool is_to_dark = plan.border == Border::kDark && best_->border == Border::kLit;
      const bool is_to_more = plan.maps.size() > best_->maps.size();
      below = is_to_dark ? kDarkBorderBelow : is_to_more ? kMoreMapsBelow : 1.0;
    }
    if (!best_.has_value() || *share < below * *best_->wrong_share) best_ = std::move(plan);
    return absl::OkStatus();
  }

  bool is_empty() const { return !best_.has_value(); }
  LightPlan&& Best() && { return *std::move(best_); }

 private:
  const Surfaces& surfaces_;
  const Light& light_;
  const PlanOptions& options_;
  std::optional<LightPlan> best_;
};

// Plans of one light with one border.
class BorderPlanner {
 public:
  // The view and the options must outlive the planner.
  BorderPlanner(const LightView& view,
                const ServedRays& rays,
                const FitOptions& fit,
                const PlanOptions& options)
      : view_(view),
        options_(options),
        fitter_(rays, *view.light, fit),
        finisher_(view, fitter_, options),
        grown_(GrowCells(fitter_, options.max_maps)) {}

  // FailedPrecondition where there is none of so many maps.
  absl::StatusOr<LightPlan> PlanOf(int num_maps) const {
    const double texels = TexelsOf(num_maps);
    Cells cells = GrownOf(num_maps);
    if (view_.light->kind == Light::Kind::kPoint) {
      Cells clusters = ClusterCells(fitter_, num_maps, texels);
      if (!clusters.empty() &&
          (cells.empty() || DividedMaps(fitter_, clusters, texels).Energy() <
                                DividedMaps(fitter_, cells, texels).Energy())) {
        cells = std::move(clusters);
      }
    }
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    if (cells.empty()) {
      return view_.cover.ok()
                 ? absl::FailedPreconditionError(absl::StrFormat(
                       "light \"%s\": no map can be fitted to what it shows", view_.light->name))
                 : SurroundedByError(num_maps);
    }
    cells = AlternateCells(fitter_, cells, texels);
    if (absl::Status status = CheckStop(*view_.light); !status.ok()) return status;
    return finisher_.Finish(cells);
  }

 private:
  double TexelsOf(int num_maps) const {
    if (!options_.each.has_value()) return static_cast<double>(options_.texels);
    return static_cast<double>(options_.each->width) * options_.each->height * num_maps;
  }

  Cells GrownOf(int num_maps) const {
    if (grown_.empty()) return {};
    return grown_[std::min<size_t>(num_maps, grown_.size()) - 1];
  }

  // Receivers all around, and too few maps for them.
  absl::Status SurroundedByError(int num_maps) const {
    // Any rays at all have a plan of so many: one for each face of a cube.
    constexpr int kAlwaysEnough = 6;
    int enough = num_maps + 1;
    while (enough < kAlwaysEnough && ClusterCells(fitter_, enough, TexelsOf(enough)).empty()) {
      ++enough;
    }
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": at (%g, %g, %g) it hangs among its receivers, and no %d maps "
        "have all of them in front; %d would do",
        view_.light->name,
        view_.light->position.x(),
        view_.light->position.y(),
        view_.light->position.z(),
        num_maps,
        enough));
  }

  const LightView& view_;
  const PlanOptions& options_;
  CellFitter fitter_;
  Finisher finisher_;
  ScratchVector<Cells> grown_;
};

// 2, 4, 8 ... below `most`, and `most`.
ScratchVector<int> CountsUpTo(int most) {
  ScratchVector<int> counts;
  for (int count = 2; count < most; count *= 2) counts.push_back(count);
  counts.push_back(most);
  return counts;
}

// Plans with one border; `choice` is null where the one of most maps is wanted.
absl::StatusOr<LightPlan> FitInBorder(const Surfaces& surfaces,
                                      const Light& light,
                                      Border border,
                                      const PlanOptions& options,
                                      Choice* choice) {
  FitOptions fit = options.fit;
  fit.border = BorderChoice::kAutomatic;  // that of the view
  const absl::StatusOr<LightView> view = ViewLight(surfaces, light, border, fit);
  if (!view.ok()) return view.status();
  const absl::StatusOr<ServedRays> rays = FindServedRays(*view, fit);
  if (!rays.ok()) return rays.status();
  const BorderPlanner planner(*view, *rays, fit, options);
  if (choice == nullptr) return planner.PlanOf(options.max_maps);
  absl::StatusOr<LightPlan> last = PlanOfOneMap(options, *view);
  if (last.ok()) {
    if (absl::Status status = choice->Offer(*last); !status.ok()) return status;
  }
  for (const int count : CountsUpTo(options.max_maps)) {
    last = planner.PlanOf(count);
    if (absl::IsCancelled(last.status())) return last;
    if (!last.ok()) continue;
    if (absl::Status status = choice->Offer(*last); !status.ok()) return status;
  }
  return last;
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
  if (options.max_maps == 1) return PlanOfOneMap(options, surfaces, light);
  const BorderChoice border = options.fit.border;
  const Border first = border == BorderChoice::kDark ? Border::kDark : Border::kLit;
  if (!options.choose_by_forecast || !surfaces.readback.KnowsFacing(light.shadow_bit)) {
    return FitInBorder(surfaces, light, first, options, nullptr);
  }
  Choice choice(surfaces, light, options);
  absl::StatusOr<LightPlan> last = FitInBorder(surfaces, light, first, options, &choice);
  if (absl::IsCancelled(last.status())) return last;
  if (border == BorderChoice::kAutomatic) {
    absl::StatusOr<LightPlan> dark = FitInBorder(surfaces, light, Border::kDark, options, &choice);
    if (absl::IsCancelled(dark.status())) return dark;
  }
  if (choice.is_empty()) return last;
  return std::move(choice).Best();
}

}  // namespace lightfit
