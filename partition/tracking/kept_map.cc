#include "partition/tracking/kept_map.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/homography.h"
#include "partition/tracking/held_bins.h"

namespace lightfit {

absl::StatusOr<KeptMap> MakeKeptMap(const LightView& view,
                                    const Eigen::Matrix4d& map_from_world,
                                    MapSize size,
                                    TrackerAction action) {
  const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map_from_world, *view.light);
  if (!map_from_ray.ok()) return map_from_ray.status();
  const RayMap rays(*map_from_ray * view.normalized_from_ray().inverse(), size.width, size.height);
  return KeptMap{map_from_world, size, rays, action};
}

std::optional<KeptMap> ShiftedToHold(const KeptMap& map,
                                     const ScratchVector<Eigen::Vector3d>& rays,
                                     double guard_texels) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& ray : rays) {
    const Eigen::Vector3d at = map.rays.map_from_ray * ray;
    if (!(at.z() > 0.0)) return std::nullopt;
    box.extend(at.hnormalized().eval());
  }
  const Eigen::Vector2d first = Eigen::Vector2d::Constant(guard_texels - kHeldTolerance);
  const Eigen::Vector2d last = Eigen::Vector2d(map.size.width, map.size.height) - first;
  if (box.isEmpty() || Eigen::AlignedBox2d(first, last).contains(box)) return map;
  const std::optional<double> u =
      WholeTexelShift(box.min().x(), box.max().x(), first.x(), last.x());
  const std::optional<double> v =
      WholeTexelShift(box.min().y(), box.max().y(), first.y(), last.y());
  if (!u.has_value() || !v.has_value()) return std::nullopt;
  KeptMap shifted = map;
  shifted.map_from_world.row(0) += *u * map.map_from_world.row(3);
  shifted.map_from_world.row(1) += *v * map.map_from_world.row(3);
  Eigen::Matrix3d map_from_ray = map.rays.map_from_ray;
  map_from_ray.row(0) += *u * map_from_ray.row(2);
  map_from_ray.row(1) += *v * map_from_ray.row(2);
  shifted.rays = RayMap(map_from_ray, map.size.width, map.size.height);
  if (!IsRedrawn(map.action)) shifted.action = TrackerAction::kShifted;
  return shifted;
}

ScratchVector<RayMap> RayMapsOf(const KeptMaps& maps) {
  ScratchVector<RayMap> ray_maps;
  ray_maps.reserve(maps.size());
  for (const KeptMap& map : maps) ray_maps.push_back(map.rays);
  return ray_maps;
}

bool IsRedrawn(TrackerAction action) {
  return action != TrackerAction::kKept && action != TrackerAction::kShifted;
}

}  // namespace lightfit
