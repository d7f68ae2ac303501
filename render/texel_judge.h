// render/texel_judge.h
//
// What a texel of a shadow map says about a receiver that looks it up, under both bias models.
// In:   a RayCaster, the maps with their rays, what is drawn into them; a receiver and its texel.
// Out:  whether the receiver is dark.   math.md 10
//
// render/judge.h says what the models are.
#pragma once

#include <cstdint>
#include <utility>

#include "render/ray_caster.h"
#include "render/surface_image.h"
#include "render/texel_maps.h"

namespace lightfit {

class TexelJudge {
 public:
  // Refers to all of them. `constant_bias` is that of the practical model, world units along the
  // ray.
  TexelJudge(const RayCaster& caster,
             const TexelMaps& maps,
             const TexelHits& hits,
             double constant_bias);

  // {ideal, practical}: whether the texel says that the receiver is dark. From any number of
  // threads at once.
  std::pair<bool, bool> IsDark(const SurfacePoint& receiver, int32_t texel) const;

 private:
  const RayCaster& caster_;
  const TexelMaps& maps_;
  const TexelHits& hits_;
  double constant_bias_;
};

}  // namespace lightfit
