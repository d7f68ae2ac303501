#include "calls/plan_trackers.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "jobs/matrix_judge.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"
#include "wire/plan_shot_proto.h"

namespace lightfit {
namespace {

// A plan that serves nothing of a frame has no figures there, and is kept all the same.
Figures FiguresOf(const TrackedPlan& tracked,
                  const Surfaces& surfaces,
                  const Light& light,
                  const PlanOptions& options) {
  absl::StatusOr<Figures> figures =
      OwnFiguresOf(tracked.plan, surfaces, light, options, /*foretells=*/false);
  if (figures.ok()) return *std::move(figures);
  Figures none;
  none.energy = tracked.plan.energy;
  return none;
}

}  // namespace

absl::Status PlanTrackers::SetState(
    const google::protobuf::RepeatedPtrField<v1::TrackedState>& state) {
  given_.clear();
  for (int i = 0; i < state.size(); ++i) {
    absl::StatusOr<TrackedPlanState> plan =
        TrackedPlanStateFromProto(state[i], absl::StrCat("state[", i, "]"));
    if (!plan.ok()) return plan.status();
    given_.push_back(*std::move(plan));
  }
  return absl::OkStatus();
}

PlanTracker PlanTrackers::TrackerOf(const Light& light) const {
  for (const PlanTracker& tracker : trackers_) {
    if (tracker.light().name != light.name) continue;
    PlanTracker same = tracker;
    same.set_light(light);
    return same;
  }
  PlanTracker tracker(light, options_);
  for (const TrackedPlanState& given : given_) {
    if (given.light.name != light.name) continue;
    TrackedPlanState state = given;
    state.light = light;
    tracker.set_state(std::move(state));
  }
  return tracker;
}

TrackedFits PlanTrackers::Update(const Readback& readback,
                                 const std::vector<RequestLight>& lights) {
  std::vector<Light> usable;
  for (const RequestLight& light : lights) {
    if (light.status.ok()) usable.push_back(light.light);
  }
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(readback, LightMask(usable), options_.plan.fit.samples);
  TrackedFits frame;
  std::vector<PlanTracker> trackers;
  for (const RequestLight& light : lights) {
    LightFit& fit = frame.fits.emplace_back();
    v1::ShotLight& shot = frame.shots.emplace_back();
    fit.light = light.light;
    if (!light.status.ok()) {
      fit.matrix = light.status;
      continue;
    }
    PlanTracker& tracker = trackers.emplace_back(TrackerOf(light.light));
    absl::StatusOr<TrackedPlan> tracked =
        surfaces.ok() ? tracker.Update(*surfaces) : surfaces.status();
    if (!tracked.ok()) {
      fit.matrix = tracked.status();
      continue;
    }
    *shot.mutable_plan() = ShotPlanToProto(*tracked);
    const Figures figures = FiguresOf(*tracked, *surfaces, light.light, options_.plan);
    SetPlan(std::move(tracked->plan), figures, options_.plan.guard_texels, &fit);
  }
  trackers_ = std::move(trackers);
  given_.clear();
  return frame;
}

std::vector<v1::TrackedState> PlanTrackers::State() const {
  std::vector<v1::TrackedState> state;
  for (const PlanTracker& tracker : trackers_) {
    if (tracker.state().maps.empty()) continue;
    state.push_back(TrackedPlanStateToProto(tracker.state()));
  }
  return state;
}

}  // namespace lightfit
