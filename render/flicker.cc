#include "render/flicker.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "absl/strings/str_format.h"

namespace lightfit {
absl::StatusOr<std::vector<uint8_t>> SeenFrom(const Camera& other,
                                              const RayCaster& caster,
                                              const SurfaceImage& image) {
  if (absl::Status status = ValidateCamera(other); !status.ok()) return status;
  // A camera sees what a light in its place would light.
  const Eigen::Matrix4d world_from_camera = other.camera_from_world.inverse();
  const Light eye = other.orthographic
                        ? Light::Directional("eye", world_from_camera.block<3, 1>(0, 2))
                        : Light::Point("eye", world_from_camera.block<3, 1>(0, 3));
  const std::vector<Lighting> lighting = TrueLighting(caster, image, eye);
  const Eigen::Matrix4d screen_from_world = other.ScreenFromWorld();
  std::vector<uint8_t> seen(image.pixels.size(), 0);
  for (size_t i = 0; i < seen.size(); ++i) {
    if (lighting[i] != Lighting::kLit) continue;
    const Eigen::Vector4d screen = screen_from_world * image.pixels[i].position.homogeneous();
    if (!(screen.w() > 0.0) || !(screen.z() > 0.0)) continue;
    const double x = screen.x() / screen.w(), y = screen.y() / screen.w();
    seen[i] = x >= 0.0 && x < other.width && y >= 0.0 && y < other.height ? 1 : 0;
  }
  return seen;
}

Flicker CountFlips(const ShadowImage& a,
                   const ShadowImage& b,
                   absl::Span<const uint8_t> seen_in_both) {
  Flicker flicker;
  for (size_t i = 0; i < seen_in_both.size(); ++i) {
    if (!IsJudged(a.ideal[i]) || seen_in_both[i] == 0) continue;
    ++flicker.judged;
    if (a.ideal[i] != b.ideal[i]) ++flicker.flips_ideal;
    if (a.practical[i] != b.practical[i]) ++flicker.flips_practical;
  }
  return flicker;
}

absl::StatusOr<Flicker> MeasureFlicker(const RayCaster& caster,
                                       const SurfaceImage& image,
                                       absl::Span<const uint8_t> seen_in_both,
                                       absl::Span<const Lighting> truth,
                                       const Light& light,
                                       const JudgedMap& a,
                                       const JudgedMap& b,
                                       const JudgeOptions& options) {
  if (seen_in_both.size() != image.pixels.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("seen_in_both has %d pixels, the image %d: want those of the image",
                        seen_in_both.size(),
                        image.pixels.size()));
  }
  const absl::StatusOr<ShadowImage> shadows_a =
      JudgeFirstPhase(caster, image, truth, light, a, options);
  if (!shadows_a.ok()) return shadows_a.status();
  const absl::StatusOr<ShadowImage> shadows_b =
      JudgeFirstPhase(caster, image, truth, light, b, options);
  if (!shadows_b.ok()) return shadows_b.status();
  return CountFlips(*shadows_a, *shadows_b, seen_in_both);
}

}  // namespace lightfit
