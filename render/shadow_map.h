// render/shadow_map.h
//
// The shadow map of any matrix, by casting the ray through each texel's centre.
// In:   a RayCaster, a Light, map_from_ray (geometry/homography.h) and the map's size.
// Out:  the first hit of every texel, as a distance along its ray.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "render/ray_caster.h"

namespace lightfit {

// The world-space rays of a map. Point light: from the light. Directional: from a plane across the
// light's direction, in front of all geometry, so that distances of different rays compare.
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

struct ShadowMap {
  MapSize size;
  std::vector<double> distance;  // row-major, world units along the ray; infinite without a hit
};

// `wanted`: row-major, 0 for texels that nobody looks up, which are left infinite; empty: all.
ShadowMap RenderShadowMap(const RayCaster& caster,
                          const Light& light,
                          const Eigen::Matrix3d& map_from_ray,
                          MapSize size,
                          absl::Span<const uint8_t> wanted = {});

}  // namespace lightfit
