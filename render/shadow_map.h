// render/shadow_map.h
//
// The world-space rays of any matrix's shadow map.
// In:   a Light, map_from_ray (geometry/homography.h), the box around all geometry.
// Out:  the ray through any point of the map.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "geometry/light.h"
#include "render/ray_caster.h"

namespace lightfit {

// How far along the unit `direction` of a sun's light its rays start: in front of all geometry, in
// one plane across the direction, so that distances of different rays compare.
double StartOfSunRays(const Eigen::Vector3d& direction, const Eigen::AlignedBox3d& bounds);

// From a point light itself, or from where StartOfSunRays() says.
class MapRays {
 public:
  MapRays(const Light& light,
          const Eigen::Matrix3d& map_from_ray,
          const Eigen::AlignedBox3d& bounds);

  // The ray through the point (u, v) of the map, texels; nothing where the warp puts no ray.
  std::optional<Ray> At(double u, double v) const;

 private:
  bool is_point_;
  Eigen::Matrix3d ray_from_map_;
  Eigen::Matrix3d axes_;    // rows: light space from world
  Eigen::Vector3d centre_;  // the light's position, or the origin moved in front of the geometry
};

}  // namespace lightfit
