#include "partition/fit_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optimizer/choose_fit.h"
#include "optimizer/fit.h"
#include "partition/evaluate_plan.h"
#include "partition/finish_plan.h"
#include "partition/plan_cells.h"
#include "partition/plan_sizes.h"

namespace lightfit {

namespace {

// How much less must be foretold for a plan of more maps to be taken: docs/plans.md.
constexpr double kMoreMapsBelow = 0.95;

LightPlan OneMapPlan(const LightMatrix& matrix) {
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
absl::StatusOr<LightPlan> FitOneMap(const PlanOptions& options, const From&... from) {
  FitOptions fit = options.fit;
  fit.margin_texels += options.guard_texels;
  if constexpr (sizeof...(From) == 1) fit.border = BorderChoice::kAutomatic;  // that of the view
  const absl::StatusOr<LightMatrix> matrix = FitLight(from..., SizeOfOneMap(options), fit);
  if (!matrix.ok()) return matrix.status();
  return OneMapPlan(*matrix);
}

// The best plan so far, by what is foretold where that is asked for.
class Choice {
 public:
  Choice(const Surfaces& surfaces, const Light& light, const PlanOptions& options)
      : surfaces_(surfaces), light_(light), options_(options) {}

  absl::Status Offer(LightPlan plan) {
    const absl::StatusOr<double> share =
        ForetellPlan(surfaces_.readback, light_, PlanOf(plan), options_.fit.samples);
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

absl::StatusOr<LightPlan> PlanOfCells(const LightView& view,
                                      const PlanCells& plan_cells,
                                      int num_maps,
                                      const PlanOptions& options) {
  const absl::StatusOr<Cells> cells = plan_cells.Of(num_maps);
  if (!cells.ok()) return cells.status();
  return FinishPlan(view, plan_cells.fitter(), *cells, options);
}

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
  // Few say nothing of a border between maps: the focused map, as of one map.
  if (view->cover.ok() &&
      static_cast<int>(view->samples.size()) < options.fit.samples.min_samples) {
    absl::StatusOr<LightPlan> one = FitOneMap(options, *view);
    if (one.ok() && choice != nullptr) {
      if (absl::Status status = choice->Offer(*one); !status.ok()) return status;
    }
    return one;
  }
  const absl::StatusOr<ServedRays> rays = FindServedRays(*view, fit);
  if (!rays.ok()) return rays.status();
  const PlanCells cells(*rays, light, fit, options);
  if (choice == nullptr) return PlanOfCells(*view, cells, options.max_maps, options);
  absl::StatusOr<LightPlan> last = FitOneMap(options, *view);
  if (last.ok()) {
    if (absl::Status status = choice->Offer(*last); !status.ok()) return status;
  }
  for (const int count : CountsUpTo(options.max_maps)) {
    last = PlanOfCells(*view, cells, count, options);
    if (absl::IsCancelled(last.status())) return last;
    if (!last.ok()) continue;
    if (absl::Status status = choice->Offer(*last); !status.ok()) return status;
  }
  return last;
}

// Whether the read-back has one that the options take in and that knows what this border answers
// wrongly.
bool HasFineCover(const Surfaces& surfaces,
                  const Light& light,
                  Border border,
                  const PlanOptions& options) {
  const FineCover* fine = surfaces.readback.fine_cover;
  return fine != nullptr && options.fit.use_fine_cover && options.fit.cover == Cover::kShadowed &&
         !fine->NeededBits(border, light.shadow_bit).empty();
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
  if (options.max_maps == 1) return FitOneMap(options, surfaces, light);
  const BorderChoice border = options.fit.border;
  const Border first = border == BorderChoice::kDark ? Border::kDark : Border::kLit;
  PlanOptions coarse = options;
  coarse.fit.use_fine_cover = false;
  if (!options.choose_by_forecast || !surfaces.readback.KnowsFacing(light.shadow_bit)) {
    if (HasFineCover(surfaces, light, first, options)) {
      absl::StatusOr<LightPlan> plan = FitInBorder(surfaces, light, first, options, nullptr);
      // Around a lamp it may want more maps than there may be: left out, as by one map.
      if (!absl::IsFailedPrecondition(plan.status())) return plan;
    }
    return FitInBorder(surfaces, light, first, coarse, nullptr);
  }
  ScratchVector<Border> borders = {first};
  if (border == BorderChoice::kAutomatic) borders.push_back(Border::kDark);
  Choice choice(surfaces, light, options);
  absl::Status why_none;
  for (const bool is_fine : {false, true}) {
    const PlanOptions& tried = is_fine ? options : coarse;
    for (const Border with : borders) {
      if (is_fine && !HasFineCover(surfaces, light, with, options)) continue;
      const absl::StatusOr<LightPlan> last = FitInBorder(surfaces, light, with, tried, &choice);
      if (absl::IsCancelled(last.status())) return last.status();
      why_none.Update(last.status());
    }
  }
  if (choice.is_empty()) return why_none;
  return std::move(choice).Best();
}

}  // namespace lightfit
