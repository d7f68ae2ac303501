#include "jobs/shot/answer.h"

namespace lightfit {

Plan LookUpOf(const ShotAnswer& answer) {
  if (const auto* tracked = std::get_if<TrackedPlan>(&answer)) return PlanOf(tracked->plan);
  const LightMatrix& matrix = std::get<TrackedMatrix>(answer).matrix;
  return PlanOfOneMap(matrix.light_name, matrix.map_from_world, matrix.map, matrix.border);
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
