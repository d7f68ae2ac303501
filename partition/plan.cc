#include "partition/plan.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "geometry/homography.h"

namespace lightfit {

Plan PlanOfOneMap(absl::string_view light_name,
                  const Eigen::Matrix4d& map_from_world,
                  MapSize size,
                  Border border) {
  Plan plan;
  plan.light_name.assign(light_name.data(), light_name.size());
  plan.border = border;
  PlanMap& only = plan.maps.emplace_back();
  only.map_from_world = map_from_world;
  only.size = size;
  return plan;
}

int64_t NumTexels(const Plan& plan) {
  int64_t sum = 0;
  for (const PlanMap& map : plan.maps) sum += int64_t{map.size.width} * map.size.height;
  return sum;
}

absl::StatusOr<PlanLookUp> PlanLookUp::Create(const Plan& plan,
                                              const Light& light,
                                              double guard_texels) {
  if (plan.maps.empty() || plan.maps.size() > kMaxPlanMaps) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": a plan of %d maps, want 1 ... %d",
                        light.name,
                        plan.maps.size(),
                        kMaxPlanMaps));
  }
  PlanLookUp look_up;
  look_up.guard_texels_ = guard_texels;
  look_up.maps_.reserve(plan.maps.size());
  for (const PlanMap& map : plan.maps) {
    if (absl::Status status = ValidateMapSize(map.size, guard_texels); !status.ok()) return status;
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    // math.md (18): q does not depend on the scale of the homogeneous rows.
    const double scale = 1.0 / std::cbrt(std::abs(map_from_ray->determinant()));
    look_up.maps_.push_back(
        {scale * *map_from_ray * RayFromWorld(light), map.size, map.half_spaces});
  }
  return look_up;
}

bool PlanLookUp::IsAskable(int k, const Eigen::Vector3d& world, Eigen::Vector2d* texel) const {
  const Map& map = maps_[k];
  const Eigen::Vector3d at = map.rows * world.homogeneous();
  if (!(at.z() > 0.0)) return false;
  *texel = at.head<2>() / at.z();
  const bool is_inside = texel->x() >= guard_texels_ && texel->y() >= guard_texels_ &&
                         texel->x() < map.size.width - guard_texels_ &&
                         texel->y() < map.size.height - guard_texels_;
  return is_inside && IsServed(k, world);
}

bool PlanLookUp::IsServed(int k, const Eigen::Vector3d& world) const {
  for (const Eigen::RowVector4d& half_space : maps_[k].half_spaces) {
    if (!(half_space * world.homogeneous() >= 0.0)) return false;
  }
  return true;
}

double PlanLookUp::CoarsenessOf(int k, const Eigen::Vector3d& world) const {
  return maps_[k].rows.row(2) * world.homogeneous();
}

PlanPlace PlanLookUp::At(const Eigen::Vector3d& world) const {
  PlanPlace place;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < num_maps(); ++k) {
    const double coarseness = CoarsenessOf(k, world);
    Eigen::Vector2d texel;
    if (coarseness < least && IsAskable(k, world, &texel)) {
      least = coarseness;
      place = {k, texel};
    }
  }
  return place;
}

}  // namespace lightfit
