// partition/tracking/plan_tracker.h
//
// A light's plan from frame to frame: each map is kept, moved or replaced by itself.
// In:   per frame a read-back's Surfaces.
// Out:  TrackedPlan: the maps for this frame, and what was done to each.
//
// As optimizer/tracking/tracker.h does with one matrix. A plan need not change as a whole: the map
// that misses something is moved or fitted anew, the others stand still, and what is looked up in
// them does not crawl. Who asks which map is not a part of the plan (partition/plan.h), so a map
// that is kept stays right whatever becomes of the others.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/tracking/keep_matrix.h"
#include "partition/fit_plan.h"
#include "partition/plan_options.h"

namespace lightfit {

struct PlanTrackerOptions {
  PlanOptions plan;

  // A plan is kept as long as its energy is at most 1 + this times that of the frame's own plan. 0:
  // every updated frame has its own. >= 0.
  double tolerance = 0.5;

  // Every n-th frame is fitted anew to know that. Between, it is estimated by the maps' own fits.
  // >= 1.
  int update_every_frames = 3;

  // Maps that are fitted anew make room: on every side by this share of what they must hold, in
  // percent, on top of plan.fit.margin_percent. >= 0.
  double cover_margin_percent = 2.5;

  // All of the above but `plan` from one number, 0 ... 1: docs/sequences.md has the price of each.
  // As TrackerOptions::ForStability(), with half the room: a map has less to lose than the only
  // one.
  static PlanTrackerOptions ForStability(double stability);
};

// InvalidArgument names the field as options.FIELD.
absl::Status ValidatePlanTrackerOptions(const PlanTrackerOptions& options);

struct TrackedPlan {
  LightPlan plan;  // its figures are those of this frame's samples

  // Of each map, the matrix of the frame before but perhaps for its depth row: kKept, kShifted; or
  // not: kFirst in the first plan, kInvalid where something was not held, kReplaced for less energy
  // or another border.
  ScratchVector<TrackerAction> actions;
  // Of each map: since its texels last moved over surfaces, 0: in this frame.
  ScratchVector<int64_t> frames_kept;

  bool is_new = false;  // the plan as a whole: number and sizes of maps may be others

  // What the energy is compared with: in updated frames that of the frame's own plan, else an
  // estimate from above.
  double best_energy = 0.0;
  bool is_updated = false;

  int NumRedrawn() const;  // maps whose texels moved over surfaces
};

// What is remembered of a light.
struct TrackedPlanState {
  struct Map {
    Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
    MapSize size;
    int64_t frames_kept = 0;
  };
  Light light;
  Border border = Border::kLit;
  std::vector<Map> maps;  // none: no frame yet
  int64_t frames_since_update = 0;
};

// One light, one sequence of frames. Not for use by two threads at once. Inside a ScratchScope the
// results and all working memory come from there; what a tracker remembers does not.
class PlanTracker {
 public:
  PlanTracker(Light light, const PlanTrackerOptions& options) : options_(options) {
    state_.light = std::move(light);
  }

  const Light& light() const { return state_.light; }
  // From the next frame on. A light that moved gets a new plan.
  void set_light(const Light& light);

  const PlanTrackerOptions& options() const { return options_; }
  // From the next frame on. The maps so far are kept as far as the new options allow.
  void set_options(const PlanTrackerOptions& options) { options_ = options; }

  // The plan for this frame; all that must be held is, as far as the read-back knows. Errors are
  // those of FitPlan(), and leave the tracker as it was: where nothing can be fitted but the plan
  // of the frame before still holds all, that is the result.
  absl::StatusOr<TrackedPlan> Update(const Surfaces& surfaces);

  // To stop and go on in another process.
  const TrackedPlanState& state() const { return state_; }
  void set_state(TrackedPlanState state) { state_ = std::move(state); }

 private:
  PlanTrackerOptions options_;
  TrackedPlanState state_;
};

}  // namespace lightfit
