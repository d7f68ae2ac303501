#include "render/readback_image.h"

#include <limits>

namespace lightfit {

Readback ReadbackImage::View() const {
  Readback readback;
  readback.camera = camera;
  readback.depth = depth;
  readback.depth_kind = DepthKind::kCameraZ;
  readback.background = std::numeric_limits<float>::infinity();  // kReadbackBackground is
  readback.shadow_bits = shadow_bits;
  readback.facing_bits = facing_bits;
  readback.facing_lights = facing_lights;
  return readback;
}

ReadbackImage ReadbackOf(const SurfaceImage& image) {
  ReadbackImage readback;
  readback.camera = image.camera;
  readback.depth.reserve(image.pixels.size());
  for (const SurfacePoint& pixel : image.pixels) {
    readback.depth.push_back(pixel.is_surface() ? static_cast<float>(pixel.camera_z)
                                                : kReadbackBackground);
  }
  readback.shadow_bits.assign(image.pixels.size(), 0);
  readback.facing_bits.assign(image.pixels.size(), 0);
  return readback;
}

void AddShadow(absl::Span<const Lighting> lighting, int shadow_bit, ReadbackImage* readback) {
  const uint32_t bit = uint32_t{1} << shadow_bit;
  for (size_t i = 0; i < lighting.size(); ++i) {
    if (lighting[i] == Lighting::kShadowed) readback->shadow_bits[i] |= bit;
    if (lighting[i] == Lighting::kShadowed || lighting[i] == Lighting::kLit) {
      readback->facing_bits[i] |= bit;
    }
  }
  readback->facing_lights |= bit;
}

absl::StatusOr<ReadbackImage> RenderReadback(const RayCaster& caster,
                                             const Camera& camera,
                                             absl::Span<const Light> lights) {
  for (const Light& light : lights) {
    if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  }
  const absl::StatusOr<SurfaceImage> image = RenderSurfaces(caster, camera);
  if (!image.ok()) return image.status();
  ReadbackImage readback = ReadbackOf(*image);
  for (const Light& light : lights) {
    AddShadow(TrueLighting(caster, *image, light), light.shadow_bit, &readback);
  }
  return readback;
}

}  // namespace lightfit
