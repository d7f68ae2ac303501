#include "partition/fit_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/stop.h"
#include "optimizer/choose_fit.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "partition/divided_maps.h"
#include "partition/find_cells.h"
#include "partition/finish_plan.h"
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
    return FinishPlan(view_, fitter_, cells, options_);
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
