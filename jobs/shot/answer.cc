#include "jobs/shot/answer.h"

namespace lightfit {

Plan LookUpOf(const ShotAnswer& answer) {
  if (const auto* tracked = std::get_if<TrackedPlan>(&answer)) return PlanOf(tracked->plan);
  const LightMatrix& matrix = std::get<TrackedMatrix>(answer).matrix;
  Plan plan;
  plan.light_name = matrix.light_name;
  plan.border = matrix.border;
  PlanMap& map = plan.maps.emplace_back();
  map.map_from_world = matrix.map_from_world;
  map.size = matrix.map;
  return plan;
}

ShotLookUps LookUpsOf(const ShotAnswers& answers) {
  ShotLookUps look_ups;
  for (const absl::StatusOr<ShotAnswer>& answer : answers) {
    look_ups.emplace_back();
    if (answer.ok()) look_ups.back() = LookUpOf(*answer);
  }
  return look_ups;
}

}  // namespace lightfit
