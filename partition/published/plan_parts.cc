#include "partition/published/plan_parts.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "partition/published/equal_maps.h"
#include "partition/published/storage_factor.h"

namespace lightfit {

namespace {

PlanMap MapOfSize(const PlanPart& part, MapSize size, double margin_texels) {
  PlanMap map;
  const Eigen::Vector4d scale(size.width, size.height, 1.0, 1.0);
  map.map_from_world = WithMargin(scale.asDiagonal() * part.map_from_world, size, margin_texels);
  map.size = size;
  for (const Eigen::Vector4d& half_space : part.half_spaces) {
    map.half_spaces.emplace_back(half_space.transpose());
  }
  return map;
}

// M_u and M_v; ones where nothing is in view of the part.
absl::StatusOr<BeamErrors> ErrorsOf(const PlanPart& part, const MethodInput& input) {
  absl::StatusOr<BeamErrors> errors =
      MaxBeamErrors(part.map_from_world, input.light, input.camera, part.corners);
  if (!errors.ok()) return errors.status();
  const double product = errors->u * errors->v;
  if (!std::isfinite(product) || !(product > 0.0)) return BeamErrors{1.0, 1.0};
  return errors;
}

}  // namespace

MapSize SizeOfAspect(double texels, double aspect, int min_side) {
  const double most = std::min(std::floor(texels / min_side), 1.0 * kMaxMapSide);
  const double width = std::clamp(std::round(std::sqrt(texels * aspect)), 1.0 * min_side, most);
  const double height = std::min(std::floor(texels / width), 1.0 * kMaxMapSide);
  return {static_cast<int>(width), static_cast<int>(height)};
}

absl::StatusOr<Plan> PlanOfParts(const MethodInput& input,
                                 const std::vector<PlanPart>& parts,
                                 PlanShapes shapes,
                                 double margin_texels) {
  const int num_parts = static_cast<int>(parts.size());
  if (num_parts < 1 || num_parts > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": a plan of %d maps, want 1 ... %d",
                        input.light.name,
                        num_parts,
                        kMaxPlanMaps));
  }
  // Also says when there are too few texels.
  const absl::StatusOr<MapSize> square = EqualSquares(input.map, num_parts, margin_texels);
  if (!square.ok()) return square.status();
  Plan plan;
  plan.light_name = input.light.name;
  if (shapes == PlanShapes::kEqualSquares) {
    for (const PlanPart& part : parts) {
      plan.maps.push_back(MapOfSize(part, *square, margin_texels));
    }
    return plan;
  }
  std::vector<BeamErrors> errors;
  double sum = 0.0;
  for (const PlanPart& part : parts) {
    const absl::StatusOr<BeamErrors> of_part = ErrorsOf(part, input);
    if (!of_part.ok()) return of_part.status();
    errors.push_back(*of_part);
    sum += of_part->u * of_part->v;
  }
  // Each has room for the margin, and a share of the rest.
  const int min_side = static_cast<int>(2.0 * margin_texels) + 1;
  const double least = 1.0 * min_side * min_side;
  const double rest = 1.0 * input.map.width * input.map.height - num_parts * least;
  for (int i = 0; i < num_parts; ++i) {
    const double share =
        shapes == PlanShapes::kByStorage ? errors[i].u * errors[i].v / sum : 1.0 / num_parts;
    const MapSize size = SizeOfAspect(least + share * rest, errors[i].u / errors[i].v, min_side);
    plan.maps.push_back(MapOfSize(parts[i], size, margin_texels));
  }
  return plan;
}

}  // namespace lightfit
