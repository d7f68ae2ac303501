#include "partition/published/refocused_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "methods/light_body.h"
#include "methods/view_body.h"
#include "partition/published/equal_maps.h"
#include "partition/published/separating_plane.h"
#include "partition/published/view_grid.h"

namespace lightfit {

namespace {

absl::Status ValidateOptions(const RefocusOptions& options) {
  if (options.max_rounds < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "mikkelsen: max_rounds = %d, want at least 1; the paper has 10 to 20", options.max_rounds));
  }
  return ValidateMargin("mikkelsen", options.margin_texels);
}

// One view, and what does not change from round to round.
class Refocus {
 public:
  Refocus(const MethodInput& input, const RefocusOptions& options)
      : input_(input), options_(options), methods_{options.first, options.second} {}

  absl::StatusOr<RefocusRounds> Run() {
    absl::StatusOr<LightBody> body = BodyInView(input_);
    if (!body.ok()) return body.status();
    body_ = *std::move(body);
    grid_ = ViewGrid(input_);
    absl::StatusOr<RefocusRound> round = FirstRound();
    if (!round.ok()) return round.status();
    RefocusRounds result;
    result.rounds.push_back(*std::move(round));
    while (static_cast<int>(result.rounds.size()) < options_.max_rounds &&
           result.rounds.back().plan.maps.size() == 2) {
      round = NextRound(result.rounds.back());
      if (!round.ok()) break;
      result.rounds.push_back(*std::move(round));
      const size_t last = result.rounds.size() - 1;
      if (result.rounds[last].texel_side < result.rounds[result.best].texel_side) {
        result.best = last;
      }
    }
    return result;
  }

 private:
  // Both maps around all of the view, and the plane between them.
  absl::StatusOr<RefocusRound> FirstRound() const {
    RefocusRound round;
    for (int k = 0; k < 2; ++k) {
      absl::StatusOr<PlanMap> map = MapOf(k, 2, {});
      if (!map.ok()) return map.status();
      round.plan.maps.push_back(*std::move(map));
    }
    const absl::StatusOr<Eigen::RowVector4d> plane = PlaneOf(round.plan);
    if (!plane.ok()) return plane.status();
    if (const std::optional<int> only = OnlySide(round.plan, *plane)) return SingleMap(*only);
    return Finished(*plane, std::move(round));
  }

  // Each map around its side of the plane between those before.
  absl::StatusOr<RefocusRound> NextRound(const RefocusRound& before) const {
    const absl::StatusOr<Eigen::RowVector4d> plane = PlaneOf(before.plan);
    if (!plane.ok()) return plane.status();
    if (const std::optional<int> only = OnlySide(before.plan, *plane)) return SingleMap(*only);
    RefocusRound round;
    for (int k = 0; k < 2; ++k) {
      absl::StatusOr<PlanMap> map = MapOf(k, 2, {CutOf(k, *plane)});
      if (!map.ok()) return map.status();
      round.plan.maps.push_back(*std::move(map));
    }
    return Finished(*plane, std::move(round));
  }

  absl::StatusOr<RefocusRound> SingleMap(int k) const {
    RefocusRound round;
    round.only = k;
    absl::StatusOr<PlanMap> map = MapOf(k, 1, {});
    if (!map.ok()) return map.status();
    round.plan.maps.push_back(*std::move(map));
    return Finished(Eigen::RowVector4d::Zero(), std::move(round));
  }

  absl::StatusOr<PlanMap> MapOf(int k, int num_maps, std::vector<Eigen::Vector4d> cuts) const {
    const absl::StatusOr<MapSize> size = EqualSquares(input_.map, num_maps, options_.margin_texels);
    if (!size.ok()) return size.status();
    MethodInput input = input_;
    input.map = *size;
    input.cuts.insert(input.cuts.end(), cuts.begin(), cuts.end());
    const absl::StatusOr<MethodMap> fitted = SetUpMap(methods_[k], input);
    if (!fitted.ok()) return fitted.status();
    PlanMap map;
    map.size = *size;
    map.map_from_world = WithMargin(fitted->map_from_world, *size, options_.margin_texels);
    return map;
  }

  absl::StatusOr<Eigen::RowVector4d> PlaneOf(const Plan& plan) const {
    return SeparatingPlane(plan.maps[0].map_from_world, plan.maps[1].map_from_world, input_.light);
  }

  static Eigen::Vector4d CutOf(int k, const Eigen::RowVector4d& plane) {
    return (k == 0 ? plane : Eigen::RowVector4d(-plane)).transpose();
  }

  // The map that is left, if one is: where the other is nowhere the denser one, or only in a part
  // of the view that has no area. The first where both are equal.
  std::optional<int> OnlySide(const Plan& plan, const Eigen::RowVector4d& plane) const {
    const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, input_.light);
    if (!look_up.ok()) return std::nullopt;
    constexpr double kEqual = 1e-9;  // of q: rounding of the maps
    std::array<bool, 2> is_denser = {false, false};
    for (const Eigen::Vector3d& point : body_.points) {
      const double least_difference = kEqual * std::max(std::abs(look_up->CoarsenessOf(0, point)),
                                                        std::abs(look_up->CoarsenessOf(1, point)));
      const double difference = plane.dot(point.homogeneous());
      is_denser[0] = is_denser[0] || difference > least_difference;
      is_denser[1] = is_denser[1] || -difference > least_difference;
    }
    for (int k = 0; k < 2; ++k) {
      if (!is_denser[1 - k]) return k;
      MethodInput other = input_;
      other.cuts.push_back(CutOf(1 - k, plane));
      const absl::StatusOr<LightBody> side = BodyInView(other);
      if (!side.ok() || !side->in_view) return k;
    }
    return std::nullopt;
  }

  absl::StatusOr<RefocusRound> Finished(const Eigen::RowVector4d& plane, RefocusRound round) const {
    round.plane = plane;
    round.plan.light_name.assign(input_.light.name.begin(), input_.light.name.end());
    if (round.plan.maps.size() == 2 && input_.light.kind == Light::Kind::kDirectional) {
      round.plan.maps[0].half_spaces = {plane};
      round.plan.maps[1].half_spaces = {-plane};
    }
    const absl::StatusOr<PlanLookUp> look_up =
        PlanLookUp::Create(round.plan, input_.light, options_.margin_texels);
    if (!look_up.ok()) return look_up.status();
    round.texel_side = MeanTexelSide(*look_up, grid_);
    return round;
  }

  const MethodInput& input_;
  const RefocusOptions& options_;
  std::array<Method, 2> methods_;
  LightBody body_;
  std::vector<ViewGridPoint> grid_;
};

}  // namespace

absl::StatusOr<RefocusRounds> RefocusMaps(const MethodInput& input, const RefocusOptions& options) {
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  return Refocus(input, options).Run();
}

absl::StatusOr<Plan> SeparatingPlanePlan(const MethodInput& input, const RefocusOptions& options) {
  absl::StatusOr<RefocusRounds> rounds = RefocusMaps(input, options);
  if (!rounds.ok()) return rounds.status();
  return std::move(rounds->rounds[rounds->best].plan);
}

}  // namespace lightfit
