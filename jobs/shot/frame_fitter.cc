#include "jobs/shot/frame_fitter.h"

#include <utility>

#include "absl/types/span.h"
#include "optimizer/fit.h"
#include "partition/fit_plan.h"

namespace lightfit {
namespace {

absl::StatusOr<ShotAnswer> FitOne(const ShotJob& job, const FrameViews& views, size_t light) {
  if (!views[light].ok()) return views[light].status();
  if (job.plans.has_value()) {
    absl::StatusOr<LightPlan> plan =
        FitPlan(*views.surfaces(), views.lights()[light], job.plans->plan);
    if (!plan.ok()) return plan.status();
    TrackedPlan tracked;
    tracked.is_new = true;
    tracked.actions.assign(plan->maps.size(), TrackerAction::kReplaced);
    tracked.frames_kept.assign(plan->maps.size(), 0);
    tracked.plan = *std::move(plan);
    return tracked;
  }
  absl::StatusOr<LightMatrix> matrix =
      job.fit().border == BorderChoice::kAutomatic
          ? FitLight(*views.surfaces(), views.lights()[light], job.map, job.fit())
          : FitLight(*views[light], job.map, job.fit());
  if (!matrix.ok()) return matrix.status();
  return TrackedMatrix{*std::move(matrix), TrackerAction::kReplaced, 0};
}

}  // namespace

ShotAnswers FitFrame(const ShotJob& job, const FrameViews& views) {
  ShotAnswers answers;
  for (size_t i = 0; i < job.lights.size(); ++i) answers.push_back(FitOne(job, views, i));
  return answers;
}

ShotTracker::ShotTracker(const ShotJob& job) : job_(job), matrices_(job.tracker) {
  if (!job.plans.has_value()) return;
  for (const Light& light : job.lights) plans_.emplace_back(light, *job.plans);
}

ShotAnswers ShotTracker::Track(const absl::StatusOr<ReadbackFile>& file, const FrameViews& views) {
  ShotAnswers answers;
  if (!job_.plans.has_value()) {
    for (absl::StatusOr<TrackedMatrix>& matrix : TrackMatrices(file, views)) {
      if (matrix.ok()) {
        answers.emplace_back(*std::move(matrix));
      } else {
        answers.emplace_back(matrix.status());
      }
    }
    return answers;
  }
  for (size_t i = 0; i < job_.lights.size(); ++i) {
    if (!views[i].ok()) {
      answers.emplace_back(views[i].status());
      continue;
    }
    absl::StatusOr<TrackedPlan> plan = plans_[i].Update(*views.surfaces());
    if (plan.ok()) {
      answers.emplace_back(*std::move(plan));
    } else {
      answers.emplace_back(plan.status());
    }
  }
  return answers;
}

TrackedMatrices ShotTracker::TrackMatrices(const absl::StatusOr<ReadbackFile>& file,
                                           const FrameViews& views) {
  if (!file.ok()) return TrackedMatrices(job_.lights.size(), file.status());
  std::vector<Light> readable;
  for (size_t i = 0; i < job_.lights.size(); ++i) {
    if (file->light_status[i].ok()) readable.push_back(views.lights()[i]);
  }
  const absl::StatusOr<Surfaces>& surfaces = views.surfaces();
  TrackedMatrices tracked = surfaces.ok() ? matrices_.Update(*surfaces, readable, job_.map)
                                          : TrackedMatrices(readable.size(), surfaces.status());
  TrackedMatrices all;
  size_t next = 0;
  for (const absl::Status& status : file->light_status) {
    if (status.ok()) {
      all.push_back(std::move(tracked[next++]));
    } else {
      all.emplace_back(status);
    }
  }
  return all;
}

ShotStates ShotTracker::states() const {
  ShotStates states;
  if (!job_.plans.has_value()) states.matrices = matrices_.state();
  for (const PlanTracker& plan : plans_) states.plans.push_back(plan.state());
  return states;
}

void ShotTracker::set_states(const ShotStates& states) {
  if (!job_.plans.has_value()) matrices_.set_state(states.matrices);
  for (PlanTracker& plan : plans_) {
    for (const TrackedPlanState& state : states.plans) {
      if (state.light.name == plan.light().name) plan.set_state(state);
    }
  }
}

}  // namespace lightfit
