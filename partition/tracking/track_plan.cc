#include "partition/tracking/track_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/stop.h"
#include "optimizer/choose_fit.h"
#include "optimizer/light_view.h"
#include "optimizer/sizing/map_sizes.h"
#include "partition/evaluate_plan.h"
#include "partition/tracking/keep_plan.h"
#include "partition/tracking/lay_plan.h"

namespace lightfit {

namespace {

BorderChoice ChoiceOf(Border border) {
  return border == Border::kDark ? BorderChoice::kDark : BorderChoice::kLit;
}

Border OtherThan(Border border) { return border == Border::kDark ? Border::kLit : Border::kDark; }

// Which map holds what is known of the read-back's pixels alone.
PlanTrackerOptions WithoutFineCover(PlanTrackerOptions options) {
  options.plan.fit.use_fine_cover = false;
  return options;
}

// What a frame's own fit found, or why there is none; nothing where nobody has asked yet.
using OwnPlan = std::optional<absl::StatusOr<LightPlan>>;

class FrameTracker {
 public:
  FrameTracker(const Surfaces& surfaces,
               const TrackedPlanState& state,
               const PlanTrackerOptions& options)
      : surfaces_(surfaces),
        state_(state),
        light_(state.light),
        options_(WithoutFineCover(options)),
        tight_(options_.plan),
        view_fit_(options_.plan.fit),
        roomy_fit_(options_.plan.fit),
        is_update_(state.maps.empty() ||
                   state.frames_since_update + 1 >= options.update_every_frames) {
    view_fit_.border = BorderChoice::kAutomatic;  // that of the view
    roomy_fit_.margin_percent += options.cover_margin_percent;
  }

  absl::StatusOr<TrackedPlan> Track() {
    if (options_.tolerance == 0.0 && is_update_) return FrameOwnPlan();
    const BorderChoice choice = options_.plan.fit.border;
    if (!HasPlan()) return NewPlan(choice, TrackerAction::kFirst);
    if (choice != BorderChoice::kAutomatic && choice != ChoiceOf(state_.border)) {
      return NewPlan(choice, TrackerAction::kReplaced);
    }
    if (absl::Status status = LookAt(state_.border); !status.ok()) return status;
    KeptMaps maps;
    for (const TrackedPlanState::Map& map : state_.maps) {
      const absl::StatusOr<KeptMap> kept =
          MakeKeptMap(*view_, map.map_from_world, map.size, TrackerAction::kKept);
      if (!kept.ok()) return NewPlan(choice, TrackerAction::kFirst);  // set_state() gave it
      maps.push_back(*kept);
    }
    if (view_->cover.ok() && view_->cover->nothing_to_cover) {
      return ResultOf(LayUnused(*view_, maps), maps, 0.0);
    }
    if (is_update_) {
      FitOwn();
      if (absl::IsCancelled(own_->status())) return own_->status();
      const absl::StatusOr<bool> flips = Flips();
      if (!flips.ok()) return flips.status();
      if (*flips) return NewPlan(ChoiceOf(OtherThan(state_.border)), TrackerAction::kReplaced);
    }
    return maps.size() == 1 ? TrackOne(maps.front()) : TrackSeveral(std::move(maps));
  }

 private:
  // Whether there are maps, and the options allow them still.
  bool HasPlan() const {
    const PlanOptions& plan = options_.plan;
    if (state_.maps.empty() || static_cast<int>(state_.maps.size()) > plan.max_maps) return false;
    int64_t texels = 0;
    for (const TrackedPlanState::Map& map : state_.maps) {
      texels += TexelsOf(map.size);
      if (plan.each.has_value() &&
          (map.size.width != plan.each->width || map.size.height != plan.each->height)) {
        return false;
      }
      if (plan.sizes.has_value() && !KeepsRules(map.size, *plan.sizes)) return false;
    }
    return plan.each.has_value() || texels <= plan.texels;
  }

  // The light's view with one border, for all that is asked from here on.
  absl::Status LookAt(Border border) {
    tight_.fit.border = ChoiceOf(border);
    if (view_.has_value() && view_->border == border) return absl::OkStatus();
    absl::StatusOr<LightView> view = ViewLight(surfaces_, light_, border, view_fit_);
    if (!view.ok()) return view.status();
    view_.emplace(*std::move(view));
    return absl::OkStatus();
  }

  // The plan of this frame alone, with the border in use.
  void FitOwn() {
    if (!own_.has_value()) own_ = FitPlan(surfaces_, light_, tight_);
  }

  // Whether the other border's plan takes over, which is then the frame's own; as
  // BorderByForecast().
  absl::StatusOr<bool> Flips() {
    const PlanOptions& plan = options_.plan;
    if (plan.fit.border != BorderChoice::kAutomatic || !own_->ok() ||
        !(plan.choose_by_forecast || plan.max_maps == 1) ||
        !surfaces_.readback.KnowsFacing(light_.shadow_bit)) {
      return false;
    }
    PlanOptions other = tight_;
    other.fit.border = ChoiceOf(OtherThan(state_.border));
    absl::StatusOr<LightPlan> flipped = FitPlan(surfaces_, light_, other);
    if (absl::IsCancelled(flipped.status())) return flipped.status();
    if (!flipped.ok()) return false;
    const absl::StatusOr<double> share = WrongShareOf(**own_), of_other = WrongShareOf(*flipped);
    if (!share.ok()) return share.status();
    if (!of_other.ok()) return of_other.status();
    if (!(*of_other < kDarkBorderBelow * *share)) return false;
    own_ = std::move(flipped);
    return true;
  }

  absl::StatusOr<double> WrongShareOf(const LightPlan& plan) const {
    if (plan.wrong_share.has_value()) return *plan.wrong_share;
    return ForetellPlan(surfaces_.readback, light_, PlanOf(plan), options_.plan.fit.samples);
  }

  absl::StatusOr<TrackedPlan> FrameOwnPlan() const {
    absl::StatusOr<LightPlan> plan = FitPlan(surfaces_, light_, options_.plan);
    if (!plan.ok()) return plan.status();
    const bool is_first = state_.maps.empty();
    return NewResult(*std::move(plan), is_first ? TrackerAction::kFirst : TrackerAction::kReplaced);
  }

  static TrackedPlan NewResult(LightPlan plan, TrackerAction action) {
    TrackedPlan result;
    result.actions.assign(plan.maps.size(), action);
    result.frames_kept.assign(plan.maps.size(), 0);
    result.is_new = result.is_updated = true;
    result.best_energy = plan.energy;
    result.plan = std::move(plan);
    return result;
  }

  // Of maps that were kept, or of which some were.
  TrackedPlan ResultOf(LightPlan plan, const KeptMaps& maps, double best) const {
    TrackedPlan result;
    result.plan = std::move(plan);
    for (size_t k = 0; k < maps.size(); ++k) {
      result.actions.push_back(maps[k].action);
      result.frames_kept.push_back(IsRedrawn(maps[k].action) ? 0 : state_.maps[k].frames_kept + 1);
    }
    result.best_energy = best;
    result.is_updated = own_.has_value() && own_->ok();
    return result;
  }

  absl::StatusOr<TrackedPlan> NewPlan(BorderChoice border, TrackerAction action) {
    tight_.fit.border = border;
    return NewPlan(action);
  }

  // The frame's own plan, its maps with room where that does not cost too much.
  absl::StatusOr<TrackedPlan> NewPlan(TrackerAction action) {
    FitOwn();
    if (!own_->ok()) return own_->status();
    const LightPlan& own = **own_;
    if (!(options_.cover_margin_percent > 0.0)) return NewResult(own, action);
    if (absl::Status status = LookAt(own.border); !status.ok()) return status;
    KeptMaps maps;
    for (const LightMatrix& map : own.maps) {
      const absl::StatusOr<KeptMap> fresh =
          MakeKeptMap(*view_, map.map_from_world, map.map, action);
      if (!fresh.ok()) return fresh.status();
      maps.push_back(*fresh);
    }
    absl::StatusOr<LightPlan> plan = maps.size() == 1 ? LayRoomyOne(maps.front()) : LayRoomy(maps);
    if (!plan.ok()) return plan.status();
    plan->wrong_share = own.wrong_share;
    TrackedPlan result = NewResult(*std::move(plan), action);
    result.best_energy = own.energy;
    return result;
  }

  // The energy of the frame's own plan, where it is known.
  double BestOr(double estimate) const {
    return own_.has_value() && own_->ok() ? (*own_)->energy : estimate;
  }
  bool IsTooMuch(double energy, double best) const {
    return energy > (1.0 + options_.tolerance) * best;
  }
  // Whether there is another plan: what holds everything is not thrown away for none.
  bool CanReplace() {
    FitOwn();
    return own_->ok() || absl::IsCancelled(own_->status());
  }
  double DepthRoom() const { return options_.cover_margin_percent / 100.0; }

  absl::StatusOr<LightPlan> LayRoomyOne(const KeptMap& tight) {
    PlanOptions one = tight_;
    one.max_maps = 1;
    one.fit.margin_percent = roomy_fit_.margin_percent;
    const absl::StatusOr<LightPlan> roomy = FitPlan(surfaces_, light_, one);
    if (absl::IsCancelled(roomy.status())) return roomy.status();
    if (roomy.ok() && !IsTooMuch(roomy->energy, (*own_)->energy)) {
      const absl::StatusOr<KeptMap> map =
          MakeKeptMap(*view_, roomy->maps[0].map_from_world, roomy->maps[0].map, tight.action);
      if (map.ok()) return LayPlanOfOne(*view_, *map, view_fit_, DepthRoom());
    }
    return LayPlanOfOne(*view_, tight, view_fit_, DepthRoom());
  }

  absl::StatusOr<LightPlan> LayRoomy(const KeptMaps& maps) {
    const absl::StatusOr<ServedRays> rays = FindServedRays(*view_, view_fit_);
    if (!rays.ok()) return rays.status();
    const PlanKeeper keeper(*view_, *rays, maps, tight_, roomy_fit_);
    KeptMaps roomy = maps;
    keeper.MakeRoomy(&roomy);
    const HeldBins held = keeper.HeldBy(roomy);
    if (held.HoldsAll()) {
      absl::StatusOr<LightPlan> plan =
          LayPlan(*view_, roomy, held, view_fit_, tight_.guard_texels, DepthRoom());
      const bool will_do = plan.ok() && !IsTooMuch(plan->energy, (*own_)->energy);
      if (will_do || absl::IsCancelled(plan.status())) return plan;
    }
    return LayPlan(*view_, maps, keeper.HeldBy(maps), view_fit_, tight_.guard_texels, DepthRoom());
  }

  absl::StatusOr<TrackedPlan> TrackOne(const KeptMap& map) {
    if (!view_->cover.ok()) return NewPlan(TrackerAction::kInvalid);
    ScratchVector<Eigen::Vector3d> rays;
    for (const Eigen::Vector2d& vertex : view_->cover->hull) {
      rays.push_back(vertex.homogeneous());
    }
    const std::optional<KeptMap> kept = ShiftedToHold(map, rays, tight_.guard_texels);
    if (!kept.has_value()) return NewPlan(TrackerAction::kInvalid);
    absl::StatusOr<LightPlan> plan = LayPlanOfOne(*view_, *kept, view_fit_, DepthRoom());
    if (absl::IsCancelled(plan.status())) return plan.status();
    if (!plan.ok()) return NewPlan(TrackerAction::kInvalid);
    double best = BestOr(plan->energy);
    if (!own_.has_value()) {
      PlanOptions one = tight_;
      one.max_maps = 1;
      const absl::StatusOr<LightPlan> fitted = FitPlan(surfaces_, light_, one);
      if (absl::IsCancelled(fitted.status())) return fitted.status();
      if (fitted.ok()) best = fitted->energy;
    }
    if (IsTooMuch(plan->energy, best) && CanReplace()) return NewPlan(TrackerAction::kReplaced);
    return ResultOf(*std::move(plan), {*kept}, best);
  }

  absl::StatusOr<TrackedPlan> TrackSeveral(KeptMaps maps) {
    const absl::StatusOr<ServedRays> rays = FindServedRays(*view_, view_fit_);
    if (!rays.ok()) return rays.status();
    const KeptMaps before = maps;
    const PlanKeeper keeper(*view_, *rays, before, tight_, roomy_fit_);
    const std::optional<HeldBins> held = keeper.HoldAll(&maps);
    if (absl::Status status = CheckStop(light_); !status.ok()) return status;
    if (!held.has_value()) return NewPlan(TrackerAction::kInvalid);

    const auto lay = [&](const HeldBins& by_maps) {
      return LayPlan(*view_, maps, by_maps, view_fit_, tight_.guard_texels, DepthRoom());
    };
    absl::StatusOr<LightPlan> plan = lay(*held);
    double best = BestOr(keeper.TightEnergyOf(maps, *held));
    if (plan.ok() && IsTooMuch(plan->energy, best)) {
      // What the maps alone would gain is an estimate.
      FitOwn();
      best = BestOr(best);
      if (IsTooMuch(plan->energy, best) && LowersEnergy(keeper, best, &maps)) {
        plan = lay(keeper.HeldBy(maps));
      }
    }
    if (absl::Status status = CheckStop(light_); !status.ok()) return status;
    if (!plan.ok() || (IsTooMuch(plan->energy, best) && CanReplace())) {
      return NewPlan(TrackerAction::kReplaced);
    }
    return ResultOf(*std::move(plan), maps, best);
  }

  // Fits single maps anew, unless a new plan is the cheaper way.
  bool LowersEnergy(const PlanKeeper& keeper, double best, KeptMaps* maps) const {
    const double most = (1.0 + options_.tolerance) * best;
    KeptMaps lowered = *maps;
    const double price = keeper.LowerEnergy(most, &lowered);
    if (std::isinf(price)) return false;
    if (own_->ok()) {
      KeptMaps fresh;
      for (const LightMatrix& map : (*own_)->maps) {
        const absl::StatusOr<KeptMap> of_new =
            MakeKeptMap(*view_, map.map_from_world, map.map, TrackerAction::kReplaced);
        if (of_new.ok()) fresh.push_back(*of_new);
      }
      if (fresh.size() > 1) keeper.MakeRoomy(&fresh);
      if (keeper.costs().PriceOf(fresh, most) < price) return false;
    }
    *maps = std::move(lowered);
    return true;
  }

  const Surfaces& surfaces_;
  const TrackedPlanState& state_;
  const Light& light_;
  const PlanTrackerOptions options_;
  PlanOptions tight_;  // with the border in use
  FitOptions view_fit_, roomy_fit_;
  bool is_update_;
  std::optional<LightView> view_;
  OwnPlan own_;
};

}  // namespace

absl::StatusOr<TrackedPlan> TrackPlan(const Surfaces& surfaces,
                                      const TrackedPlanState& state,
                                      const PlanTrackerOptions& options) {
  return FrameTracker(surfaces, state, options).Track();
}

}  // namespace lightfit
