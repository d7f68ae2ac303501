// partition/tracking/async_planner.h
//
// Plans of several maps on a thread of their own, for an engine's frame loop.
// In:   from the render thread, a read-back a frame: Lend(), fill, Submit(). Neither ever waits.
// Out:  Poll(): the newest plans, stamped with the frame that they were computed from.
//
// As optimizer/tracking/async_optimizer.h, with a PlanTracker for each light: the latest wins,
// nothing is locked, and after the first few frames nothing is allocated but messages, of lights
// without a plan and of fits that the planner tries in vain.
// With PlanOptions::each and max_maps the textures can be made once; a plan may have fewer maps.
//
// Threads: one thread submits, one (the same or another) polls, each with its own functions below;
// the planner is a third. An AsyncOptimizer beside it does for lights that need one map.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/tracking/async_optimizer.h"
#include "partition/plan.h"
#include "partition/tracking/plan_tracker.h"

namespace lightfit {

struct FramePlanMap {
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();  // as LightMatrix::map_from_world
  MapSize size;                                                  // texels

  // What this frame did to the map. Frames that were never polled may have done more: to know
  // whether a map drawn earlier can stay, compare the matrix with the one that it was drawn with.
  TrackerAction action = TrackerAction::kFirst;
};

struct FramePlan {
  std::string name;
  absl::Status status;  // as PlanTracker::Update(); the rest is set when ok

  Border border = Border::kLit;  // what a receiver finds that no map holds
  int num_maps = 0;
  std::array<FramePlanMap, kMaxPlanMaps> maps;  // the first num_maps are set
  double energy = 0.0;                          // as LightPlan::energy

  // For MakePlanUniforms(). Allocates, outside of a ScratchScope.
  Plan ToPlan() const;
};

struct FramePlans {
  int64_t frame = 0;                         // FrameReadback::frame
  int num_lights = 0;                        // those of the frame, in its order
  std::array<FramePlan, kMaxLights> lights;  // the first num_lights are set

  // Null when that frame had no light of this name.
  const FramePlan* Find(absl::string_view name) const;
};

class AsyncPlanner {
 public:
  // Starts the thread, which sleeps until the first frame. InvalidArgument as
  // ValidatePlanTrackerOptions(); ResourceExhausted when no thread is to be had.
  static absl::StatusOr<AsyncPlanner> Start(const PlanTrackerOptions& options = {});

  AsyncPlanner(AsyncPlanner&&) noexcept;
  AsyncPlanner& operator=(AsyncPlanner&&) noexcept;

  // As AsyncOptimizer's.
  ~AsyncPlanner();

  // Submitting thread. As AsyncOptimizer::Lend(); map and fine_cover do not count.
  FrameReadback& Lend();

  // Submitting thread. Hands the lent buffer to the planner. A read-back that cannot be used comes
  // back as the status of its lights.
  void Submit();

  // Submitting thread. For the frames from the next Submit() on; when they are not valid
  // InvalidArgument, and the options stay as they were.
  absl::Status SetOptions(const PlanTrackerOptions& options);

  // Polling thread. The plans of the newest frame that is done, or null when the last call had
  // them. They stay until a call returns others.
  const FramePlans* Poll();

  // Any thread.
  AsyncOptimizer::Counts counts() const;

 private:
  struct Shared;
  explicit AsyncPlanner(std::unique_ptr<Shared> shared);

  std::unique_ptr<Shared> shared_;
};

}  // namespace lightfit
