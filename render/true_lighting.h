// render/true_lighting.h
//
// The exact shadow of one light: what every shadow map is judged by.
// In:   a RayCaster, a SurfaceImage, a Light.
// Out:  per pixel whether the light reaches it.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "render/surface_image.h"

namespace lightfit {

enum class Lighting : uint8_t {
  kBackground,  // no surface
  kFacingAway,  // the surface is turned away from the light: no shadow is looked up there
  kLit,
  kShadowed
};

// Whether shadows are judged at such a pixel: its surface faces the light.
inline bool IsJudged(Lighting truth) {
  return truth == Lighting::kLit || truth == Lighting::kShadowed;
}

// One ray from each surface to the light, started RayCaster::Resolution() off the surface.
std::vector<Lighting> TrueLighting(const RayCaster& caster,
                                   const SurfaceImage& image,
                                   const Light& light);

// InvalidArgument for a lighting of another number of pixels than the image's.
absl::Status ValidateLighting(absl::Span<const Lighting> truth,
                              const SurfaceImage& image,
                              const Light& light);

struct LightingCounts {
  int64_t background = 0, facing_away = 0, lit = 0, shadowed = 0;
};
LightingCounts CountLighting(const std::vector<Lighting>& lighting);

}  // namespace lightfit
