#include "render/true_lighting.h"

#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

Lighting LightingAt(const RayCaster& caster, const SurfacePoint& pixel, const Light& light) {
  if (!pixel.is_surface()) return Lighting::kBackground;
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d to_light = is_point ? Eigen::Vector3d(light.position - pixel.position)
                                            : Eigen::Vector3d(-light.direction.stableNormalized());
  if (!(pixel.normal.dot(to_light) > 0.0)) return Lighting::kFacingAway;
  const double offset = caster.Resolution(pixel.position);
  const Eigen::Vector3d start = pixel.position + offset * pixel.normal;
  const Eigen::Vector3d ray = is_point ? Eigen::Vector3d(light.position - start) : to_light;
  const double distance = ray.norm();
  if (!(distance > 0.0)) return Lighting::kLit;  // the light lies on the surface
  // A point light does not see what lies behind it.
  const double far = is_point ? distance : std::numeric_limits<double>::infinity();
  return caster.IsBlocked({start, ray / distance}, 0.0, far) ? Lighting::kShadowed : Lighting::kLit;
}

}  // namespace

std::vector<Lighting> TrueLighting(const RayCaster& caster,
                                   const SurfaceImage& image,
                                   const Light& light) {
  std::vector<Lighting> lighting(image.pixels.size());
  ParallelFor(
      static_cast<int>(image.pixels.size()), 4096, caster.num_threads(), [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
          lighting[i] = LightingAt(caster, image.pixels[i], light);
        }
      });
  return lighting;
}

absl::Status ValidateLighting(absl::Span<const Lighting> truth,
                              const SurfaceImage& image,
                              const Light& light) {
  if (truth.size() == image.pixels.size()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("light \"%s\": truth has %d pixels, the image %d: want those of the image",
                      light.name,
                      truth.size(),
                      image.pixels.size()));
}

LightingCounts CountLighting(const std::vector<Lighting>& lighting) {
  LightingCounts counts;
  for (const Lighting value : lighting) {
    switch (value) {
      case Lighting::kBackground:
        ++counts.background;
        break;
      case Lighting::kFacingAway:
        ++counts.facing_away;
        break;
      case Lighting::kLit:
        ++counts.lit;
        break;
      case Lighting::kShadowed:
        ++counts.shadowed;
        break;
    }
  }
  return counts;
}

}  // namespace lightfit
