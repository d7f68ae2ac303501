// render/readback_image.h
//
// A read-back with exact depth, shadows and facing, as a renderer would hand it over.
// In:   a RayCaster, a Camera of the read-back's size, lights; or what has been cast already.
// Out:  ReadbackImage, which owns depth and bits.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"
#include "render/ray_caster.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

struct ReadbackImage {
  Camera camera;
  std::vector<float> depth;  // camera z, world units; kReadbackBackground where nothing is hit
  std::vector<uint32_t> shadow_bits;  // bit Light::shadow_bit: faces the light and is blocked
  std::vector<uint32_t> facing_bits;  // likewise: faces the light
  uint32_t facing_lights = 0;         // bits of the lights that were added

  // Refers to this object's buffers.
  Readback View() const;
};

inline constexpr float kReadbackBackground = 1e10f;

// The depth of an image, no lights yet.
ReadbackImage ReadbackOf(const SurfaceImage& image);

// Sets bit `shadow_bit` of shadow_bits where the light is blocked, and of facing_bits where the
// surface faces it, `lighting` being that of the same image.
void AddShadow(absl::Span<const Lighting> lighting, int shadow_bit, ReadbackImage* readback);

// InvalidArgument for a camera or light that cannot be used.
absl::StatusOr<ReadbackImage> RenderReadback(const RayCaster& caster,
                                             const Camera& camera,
                                             absl::Span<const Light> lights);

}  // namespace lightfit
