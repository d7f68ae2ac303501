// render/texel_judge.h
//
// What a texel of a shadow map says about a receiver that looks it up, under both bias models.
// In:   a RayCaster, the map and the rays of its texels; a receiver and its texel.
// Out:  whether the receiver is dark.   math.md 10
//
// render/judge.h says what the models are.
#pragma once

#include <cstdint>
#include <utility>

#include "render/ray_caster.h"
#include "render/shadow_map.h"
#include "render/surface_image.h"

namespace lightfit {

class TexelJudge {
 public:
  // Refers to all of them. `constant_bias` is that of the practical model, world units along the
  // ray.
  TexelJudge(const RayCaster& caster,
             const MapRays& rays,
             const ShadowMap& map,
             double constant_bias);

  // {ideal, practical}: whether the texel, row-major, says that the receiver is dark. From any
  // number of threads at once.
  std::pair<bool, bool> IsDark(const SurfacePoint& receiver, int32_t texel) const;

 private:
  bool HasHitBehind(const Ray& ray, double first, double resolution, double far) const;

  const RayCaster& caster_;
  const MapRays& rays_;
  const ShadowMap& map_;
  double constant_bias_;
};

}  // namespace lightfit
