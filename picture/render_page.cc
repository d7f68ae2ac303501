#include "picture/render_page.h"

#include <algorithm>
#include <vector>

#include "picture/theme.h"

namespace lightfit {
namespace {

const Rgb kLitColor = HexColor(0xf4efe6);
const Rgb kGrazedColor = HexColor(0x8d8a86);  // lit, edge-on to the light
const Rgb kShadeColor = HexColor(0x4b5263);   // dark, facing the eye
const Rgb kDeepShadeColor = HexColor(0x23262f);

}  // namespace

Image DrawLighting(const SurfaceImage& image,
                   absl::Span<const Lighting> lighting,
                   const Light& light) {
  const Camera& camera = image.camera;
  const Eigen::Matrix3d world_from_camera =
      camera.camera_from_world.topLeftCorner<3, 3>().transpose();
  const Eigen::Vector3d eye = -world_from_camera * camera.camera_from_world.topRightCorner<3, 1>();
  Image picture(camera.width, camera.height, kPageColor);
  std::vector<Rgb> surfaces;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const SurfacePoint& pixel = image.pixels[i];
    if (!pixel.is_surface()) continue;
    const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                         ? Eigen::Vector3d(light.position - pixel.position)
                                         : Eigen::Vector3d(-light.direction);
    const Eigen::Vector3d to_eye = camera.orthographic ? Eigen::Vector3d(-world_from_camera.col(2))
                                                       : Eigen::Vector3d(eye - pixel.position);
    const bool is_lit = lighting[i] == Lighting::kLit;
    const double cosine = pixel.normal.dot((is_lit ? to_light : to_eye).stableNormalized());
    const auto share = static_cast<float>(std::clamp(cosine, 0.0, 1.0));
    picture.pixels()[i] =
        is_lit ? Mix(kGrazedColor, kLitColor, share) : Mix(kDeepShadeColor, kShadeColor, share);
    surfaces.push_back(picture.pixels()[i]);
  }
  const Exposure exposure = Exposure::For(surfaces);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i].is_surface()) picture.pixels()[i] = exposure(picture.pixels()[i]);
  }
  return picture;
}

}  // namespace lightfit
