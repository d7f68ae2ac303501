#include "optimizer/figures/pixel_footprint.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "geometry/homography.h"

namespace lightfit {

absl::StatusOr<PixelFootprints> PixelFootprints::Create(const Readback& readback,
                                                        const Light& light,
                                                        const Eigen::Matrix4d& map_from_world,
                                                        const SampleOptions& options) {
  const SizedMatrix map = {map_from_world, {}};
  return Create(readback, light, absl::MakeConstSpan(&map, 1), options);
}

absl::StatusOr<PixelFootprints> PixelFootprints::Create(const Readback& readback,
                                                        const Light& light,
                                                        absl::Span<const SizedMatrix> maps,
                                                        const SampleOptions& options) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (maps.empty()) return absl::InvalidArgumentError("no map, want one or more");
  PixelFootprints footprints(readback, light, options);
  for (const SizedMatrix& map : maps) {
    if (!map.map_from_world.allFinite()) {
      return absl::InvalidArgumentError("map_from_world has values that are not finite");
    }
    Map& added = footprints.maps_.emplace_back();
    added.map_from_screen << map.map_from_world.topRows<2>() * footprints.world_from_screen_,
        map.map_from_world.row(3) * footprints.world_from_screen_;
    added.size = map.size;
    if (maps.size() == 1) break;
    const absl::StatusOr<Eigen::Matrix3d> map_from_ray = MapFromRay(map.map_from_world, light);
    if (!map_from_ray.ok()) return map_from_ray.status();
    footprints.ray_maps_.push_back(RayMap(*map_from_ray, map.size.width, map.size.height));
  }
  return footprints;
}

PixelFootprints::PixelFootprints(const Readback& readback,
                                 const Light& light,
                                 const SampleOptions& options)
    : readback_(readback),
      options_(options),
      affine_depth_(AffineDepthOf(readback)),
      light_position_(light.HomogeneousPosition()),
      world_from_screen_(readback.camera.WorldFromScreen()),
      screen_from_world_(world_from_screen_.inverse()),
      ray_from_screen_(RayFromWorld(light) * world_from_screen_) {}

int PixelFootprints::MapAt(const Eigen::Vector4d& screen) const {
  return ray_maps_.empty() ? 0 : DensestAt(ray_maps_, ray_from_screen_ * screen);
}

bool PixelFootprints::IsHeldByOther(int map, const Eigen::Vector2d& texel) const {
  const Eigen::Vector3d ray = ray_maps_[map].map_from_ray.inverse() * texel.homogeneous();
  return DensestAt(ray_maps_, ray, [&](int k) { return k != map && ray_maps_[k].Holds(ray); }) >= 0;
}

std::optional<PixelFootprint> PixelFootprints::At(int x, int y) const {
  PixelFootprint result;
  DepthGradient& gradient = result.gradient;
  if (!DepthGradientAt(readback_, affine_depth_, options_, x, y, &gradient)) return std::nullopt;
  const Eigen::Vector4d screen(x + 0.5, y + 0.5, gradient.d, 1.0);
  const Eigen::Vector3d position = (world_from_screen_ * screen).hnormalized();
  const Eigen::Vector3d normal =
      SurfaceNormal(screen_from_world_, readback_.camera.orthographic, x, y, gradient);
  const Eigen::Vector3d to_light = light_position_.head<3>() - light_position_.w() * position;
  if (!(normal.dot(to_light) > options_.min_cos_light * to_light.norm())) return std::nullopt;

  // J_map_screen by the quotient rule, and its inverse.
  result.map = MapAt(screen);
  if (result.map < 0) {
    result.is_behind = true;
    return result;
  }
  const Eigen::Matrix<double, 3, 4>& map_from_screen = maps_[result.map].map_from_screen;
  const Eigen::Vector3d map = map_from_screen * screen;
  if (!(map.z() > 0.0)) {
    result.is_behind = true;
    return result;
  }
  Eigen::Matrix<double, 3, 2> derivatives;
  derivatives.col(0) = map_from_screen.col(0) + gradient.d_x * map_from_screen.col(2);
  derivatives.col(1) = map_from_screen.col(1) + gradient.d_y * map_from_screen.col(2);
  result.texel = map.hnormalized();
  const Eigen::Matrix2d J_map_screen =
      (derivatives.topRows<2>() - result.texel * derivatives.row(2)) / map.z();
  result.J_screen_map = J_map_screen.inverse();
  if (!result.J_screen_map.allFinite() || !result.texel.allFinite()) return std::nullopt;
  return result;
}

}  // namespace lightfit
