#include "optimizer/readback/needed_surfaces.h"

#include <Eigen/LU>

#include "base/stop.h"

namespace lightfit {

namespace {

// Whether the plane that the depth tells at a pixel is turned away from the light.
class AwayByNormal {
 public:
  AwayByNormal(const Surfaces& surfaces, const Light& light)
      : surfaces_(surfaces),
        options_(surfaces.options),
        screen_from_world_(surfaces.world_from_screen.inverse()),
        light_position_(light.HomogeneousPosition()) {
    options_.use_outlines = true;
  }

  bool operator()(int x, int y) const {
    const Readback& readback = surfaces_.readback;
    DepthGradient gradient;
    if (!DepthGradientAt(readback, surfaces_.affine_depth, options_, x, y, &gradient)) return false;
    const Eigen::Vector3d position =
        (surfaces_.world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, gradient.d, 1.0))
            .hnormalized();
    const Eigen::Vector3d normal =
        SurfaceNormal(screen_from_world_, readback.camera.orthographic, x, y, gradient);
    return normal.dot(light_position_.head<3>() - light_position_.w() * position) <= 0.0;
  }

 private:
  const Surfaces& surfaces_;
  SampleOptions options_;
  Eigen::Matrix4d screen_from_world_;
  Eigen::Vector4d light_position_;
};

}  // namespace

NeededSurfaces::NeededSurfaces(const Surfaces& surfaces, const Light& light, Border border) {
  const Readback& readback = surfaces.readback;
  const bool knows_facing = readback.KnowsFacing(light.shadow_bit);
  if (border == Border::kLit && !knows_facing) {
    words_ = readback.shadow_bits;
    return;
  }
  own_words_.assign(readback.depth.size(), 0);
  words_ = own_words_;
  if (knows_facing) {
    const uint32_t flip = border == Border::kDark ? ~uint32_t{0} : 0;
    for (size_t i = 0; i < own_words_.size(); ++i) {
      own_words_[i] = readback.facing_bits[i] & (readback.shadow_bits[i] ^ flip);
    }
    return;
  }
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  const AwayByNormal is_away(surfaces, light);
  for (int y = 0; y < readback.height() && !StopRequested(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      if ((readback.shadow_bits[pixel] & bit) == 0 && !is_away(x, y)) own_words_[pixel] = bit;
    }
  }
}

}  // namespace lightfit
