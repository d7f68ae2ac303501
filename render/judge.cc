#include "render/judge.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "partition/plan.h"
#include "render/judge_plan.h"

namespace lightfit {

namespace {

// n of n n phases.
int SideOf(int num_phases) { return static_cast<int>(std::lround(std::sqrt(num_phases))); }

Plan PlanOf(const JudgedMap& judged, const Light& light) {
  PlanMap map;
  map.map_from_world = judged.map_from_world;
  map.size = judged.size;
  Plan plan;
  plan.light_name = light.name;
  plan.border = judged.border;
  plan.maps.push_back(map);
  return plan;
}

}  // namespace

absl::Status ValidateJudgeOptions(const JudgeOptions& options) {
  constexpr int kMaxPhases = 64;
  if (!(options.constant_share >= 0.0) || !std::isfinite(options.constant_share)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "judge.constant_share = %g, want 0 or more: a share of the range of distances",
        options.constant_share));
  }
  const bool is_in_range = options.phases >= 1 && options.phases <= kMaxPhases;
  if (is_in_range && SideOf(options.phases) * SideOf(options.phases) == options.phases) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrFormat("judge.phases = %d, want a square number such as 1, 4 or 9, at most %d",
                      options.phases,
                      kMaxPhases));
}

Eigen::Vector2d MoveOfPhase(const JudgeOptions& options, int phase) {
  const int n = SideOf(options.phases);
  const int column = phase % n, row = phase / n;
  return Eigen::Vector2d((column + 0.5) / n - 0.5, (row + 0.5) / n - 0.5);
}

absl::StatusOr<ShadowImage> JudgeMatrix(const RayCaster& caster,
                                        const SurfaceImage& image,
                                        absl::Span<const Lighting> truth,
                                        const Light& light,
                                        const JudgedMap& map,
                                        const JudgeOptions& options) {
  return JudgePlan(caster, image, truth, light, PlanOf(map, light), options);
}

absl::StatusOr<ShadowImage> JudgeFirstPhase(const RayCaster& caster,
                                            const SurfaceImage& image,
                                            absl::Span<const Lighting> truth,
                                            const Light& light,
                                            const JudgedMap& map,
                                            const JudgeOptions& options) {
  return JudgePlanFirstPhase(caster, image, truth, light, PlanOf(map, light), options);
}

}  // namespace lightfit
