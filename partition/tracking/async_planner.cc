#include "partition/tracking/async_planner.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "base/latest_worker.h"
#include "optimizer/fit.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

namespace {

// A frame on its way to the planner.
struct Submission {
  FrameReadback readback;
  PlanTrackerOptions options;
};

// Plain copies, none of which refers to the pool that the result is made in.
void Publish(const absl::StatusOr<TrackedPlan>& result, FramePlan* plan) {
  plan->status = result.status();
  plan->num_maps = 0;
  plan->border = Border::kLit;
  plan->energy = 0.0;
  if (!result.ok()) return;
  plan->border = result->plan.border;
  plan->energy = result->plan.energy;
  plan->num_maps = std::min(static_cast<int>(result->plan.maps.size()), kMaxPlanMaps);
  for (int k = 0; k < plan->num_maps; ++k) {
    const LightMatrix& map = result->plan.maps[k];
    plan->maps[k] = {map.map_from_world, map.map, result->actions[k]};
  }
}

// The trackers of a sequence's lights, which are known by their names.
class LightTrackers {
 public:
  LightTrackers() { trackers_.reserve(kMaxLights); }

  void Update(const Submission& submission, FramePlans* plans) {
    const FrameReadback& readback = submission.readback;
    const size_t num_lights = std::min(readback.lights.size(), size_t{kMaxLights});
    plans->frame = readback.frame;
    plans->num_lights = static_cast<int>(num_lights);
    for (size_t i = 0; i < num_lights; ++i) plans->lights[i].name = readback.lights[i].name;
    if (readback.lights.size() > num_lights) {
      const absl::Status too_many = absl::InvalidArgumentError(
          absl::StrFormat("lights: %d of them, want at most %d, a shadow bit each; submit the rest "
                          "to another AsyncPlanner",
                          readback.lights.size(),
                          kMaxLights));
      for (FramePlan& plan : plans->lights) Publish(too_many, &plan);
      return;
    }
    ForgetAllBut(readback.lights);
    const absl::StatusOr<Surfaces> surfaces = FindSurfaces(
        readback.View(), LightMask(readback.lights), submission.options.plan.fit.samples);
    for (size_t i = 0; i < num_lights; ++i) {
      if (!surfaces.ok()) {
        Publish(surfaces.status(), &plans->lights[i]);
        continue;
      }
      PlanTracker& tracker = TrackerOf(readback.lights[i], submission.options);
      Publish(tracker.Update(*surfaces), &plans->lights[i]);
    }
  }

 private:
  void ForgetAllBut(absl::Span<const Light> lights) {
    const auto is_gone = [lights](const PlanTracker& tracker) {
      return std::none_of(lights.begin(), lights.end(), [&tracker](const Light& light) {
        return light.name == tracker.light().name;
      });
    };
    trackers_.erase(std::remove_if(trackers_.begin(), trackers_.end(), is_gone), trackers_.end());
  }

  PlanTracker& TrackerOf(const Light& light, const PlanTrackerOptions& options) {
    for (PlanTracker& tracker : trackers_) {
      if (tracker.light().name != light.name) continue;
      tracker.set_light(light);
      tracker.set_options(options);
      return tracker;
    }
    return trackers_.emplace_back(light, options);
  }

  std::vector<PlanTracker> trackers_;
};

}  // namespace

Plan FramePlan::ToPlan() const {
  Plan plan;
  plan.light_name = name;
  plan.border = border;
  for (int k = 0; k < num_maps; ++k) {
    PlanMap& map = plan.maps.emplace_back();
    map.map_from_world = maps[k].map_from_world;
    map.size = maps[k].size;
  }
  return plan;
}

const FramePlan* FramePlans::Find(absl::string_view name) const {
  for (int i = 0; i < num_lights; ++i) {
    if (lights[i].name == name) return &lights[i];
  }
  return nullptr;
}

// It stays in place when the AsyncPlanner moves.
struct AsyncPlanner::Shared {
  PlanTrackerOptions options;                                    // the submitting thread's
  LightTrackers trackers;                                        // the worker's
  std::unique_ptr<LatestWorker<Submission, FramePlans>> worker;  // ends before what it uses
};

absl::StatusOr<AsyncPlanner> AsyncPlanner::Start(const PlanTrackerOptions& options) {
  if (absl::Status status = ValidatePlanTrackerOptions(options); !status.ok()) return status;
  auto shared = std::make_unique<Shared>();
  shared->options = options;
  auto worker = LatestWorker<Submission, FramePlans>::Start(
      [shared = shared.get()](const Submission& submission, FramePlans* plans) {
        shared->trackers.Update(submission, plans);
      },
      "raise the limit of threads, or call PlanTrackers in a thread of your own");
  if (!worker.ok()) return worker.status();
  shared->worker = *std::move(worker);
  return AsyncPlanner(std::move(shared));
}

AsyncPlanner::AsyncPlanner(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}
AsyncPlanner::AsyncPlanner(AsyncPlanner&&) noexcept = default;
AsyncPlanner& AsyncPlanner::operator=(AsyncPlanner&&) noexcept = default;
AsyncPlanner::~AsyncPlanner() = default;

FrameReadback& AsyncPlanner::Lend() { return shared_->worker->Lend().readback; }

void AsyncPlanner::Submit() {
  shared_->worker->Lend().options = shared_->options;
  shared_->worker->Submit();
}

absl::Status AsyncPlanner::SetOptions(const PlanTrackerOptions& options) {
  absl::Status status = ValidatePlanTrackerOptions(options);
  if (status.ok()) shared_->options = options;
  return status;
}

const FramePlans* AsyncPlanner::Poll() { return shared_->worker->Poll(); }

AsyncOptimizer::Counts AsyncPlanner::counts() const {
  const auto counts = shared_->worker->counts();
  return {counts.submitted, counts.done, counts.skipped};
}

}  // namespace lightfit
