// jobs/shot/answer.h
//
// What a light has in one frame of a shot: a matrix, or where several maps were asked for a plan.
// In:   what trackers and fits give: TrackedMatrix or TrackedPlan.
// Out:  ShotAnswer, for those who need not know which; ShotLookUps, every answer as a Plan.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "optimizer/tracking/tracker.h"
#include "partition/plan.h"
#include "partition/tracking/plan_tracker.h"

namespace lightfit {

using ShotAnswer = std::variant<TrackedMatrix, TrackedPlan>;

// By light, in the order of the job.
using ShotAnswers = std::vector<absl::StatusOr<ShotAnswer>>;

// What is looked up, a single map as a plan of one; nothing where there is no answer.
using ShotLookUps = std::vector<std::optional<Plan>>;
Plan LookUpOf(const ShotAnswer& answer);
ShotLookUps LookUpsOf(const ShotAnswers& answers);

// What trackers remember between frames; one of the two is empty.
struct ShotStates {
  std::vector<TrackedState> matrices;
  std::vector<TrackedPlanState> plans;
};

}  // namespace lightfit
